"""Reads hemi's files into numpy arrays and scipy matrices.

>>> import hemi_files
>>> file = hemi_files.read_hff("box.hff")
>>> file.factors[12].toarray()            # F(12, j): what leaves patch 12 and arrives at j
>>> patches = hemi_files.read_table("patches.csv")
>>> patches["area"], patches["group"]

Needs python3-numpy and python3-scipy. Index i is the patch that light leaves, j where it arrives; both from 0.
"""

import csv
import dataclasses
import json
import struct
import zlib

import numpy
import scipy.io
import scipy.sparse

_ALIGNMENT = 8


class FileError(ValueError):
    """A file is not what it should be. The message names it and the place."""


@dataclasses.dataclass
class Factors:
    """Form factors with what belongs to them: the content of a `.hff`.

    factors      scipy.sparse.csr_matrix, N x N, float32, as computed: `hemi convert F.hff F.npz` writes them repaired
    visibility   uint8 an entry of `factors.data`, 255: nothing hidden, else V in 255ths, 1 to 254; None where it is not known
    known        bool, N: rows that were computed
    environment  float64, N: share of a row that meets nothing
    blocked      float64, N: share that meets the backs of one-sided surfaces
    areas        float64, N
    groups       names
    group_of     uint32, N: index into groups
    settings     dict: preset, method, resolution, eye_points, seed, renderer, enclosure, geometry, error ...
    patch_of     uint32, N: where faces that touch were cut, rows are those of parts, and this is the patch of the scene
                 that each is part of, as tables of patches number them; None where rows are the patches'

    The factors of the scene's patches are `by_patch()`.
    """

    factors: scipy.sparse.csr_matrix
    visibility: numpy.ndarray
    known: numpy.ndarray
    environment: numpy.ndarray
    blocked: numpy.ndarray
    areas: numpy.ndarray
    groups: list
    group_of: numpy.ndarray
    settings: dict
    patch_of: numpy.ndarray = None

    def by_patch(self):
        """F between the scene's patches: sums over parts where light arrives, means by area where it leaves."""
        if self.patch_of is None:
            return self.factors
        count = self.settings["patches"]
        parts = scipy.sparse.csr_matrix(
            (numpy.ones(len(self.areas)), (self.patch_of, numpy.arange(len(self.areas)))),
            shape=(count, len(self.areas)))
        areas = parts @ self.areas
        share = scipy.sparse.diags(1.0 / numpy.where(areas > 0.0, areas, 1.0))
        return (share @ parts.multiply(self.areas[numpy.newaxis, :]) @ self.factors.astype(numpy.float64)
                @ parts.T).tocsr()

    def by_group(self):
        """F between groups, area-weighted: [g, h] is the share of what leaves g that arrives at h.

        Rows of groups of which nothing is left, as faces that touch cover them, are 0.
        """
        members = scipy.sparse.csr_matrix(
            (numpy.ones(len(self.areas)), (self.group_of, numpy.arange(len(self.areas)))),
            shape=(len(self.groups), len(self.areas)))
        leaving = members.multiply(self.areas[numpy.newaxis, :])
        sums = (leaving @ self.factors.astype(numpy.float64) @ members.T).toarray()
        areas = members @ self.areas
        return sums / numpy.where(areas > 0.0, areas, 1.0)[:, numpy.newaxis]


def _chunks(path, magic, version):
    """Tag and payload of every chunk of one of hemi's binary files, checksums tested."""
    with open(path, "rb") as file:
        start = file.read(16)
        if len(start) < 16 or start[:8] != magic:
            raise FileError(f"{path}: does not start as such a file")
        if struct.unpack("<II", start[8:]) != (version, 0):
            raise FileError(f"{path}: version {struct.unpack('<I', start[8:12])[0]}; {version} can be read")
        while True:
            head = file.read(16)
            if len(head) < 16:
                raise FileError(f"{path}: cut short at byte {file.tell()}")
            tag, checksum, length = struct.unpack("<4sIQ", head)
            payload = file.read(length)
            if len(payload) < length:
                raise FileError(f"{path}: chunk {tag.decode('ascii', 'replace')}: cut short")
            if zlib.crc32(payload, zlib.crc32(head[8:], zlib.crc32(head[:4]))) != checksum:
                raise FileError(f"{path}: chunk {tag.decode('ascii', 'replace')}: damaged")
            file.read(-length % _ALIGNMENT)
            if tag == b"END ":
                return
            yield tag, payload


class _Payload:
    def __init__(self, path, payload):
        self.path, self.payload, self.used = path, payload, 0

    def take(self, dtype, count):
        size = numpy.dtype(dtype).itemsize * int(count)
        if size > len(self.payload) - self.used:
            raise FileError(f"{self.path}: a chunk is shorter than its own counts say")
        values = numpy.frombuffer(self.payload, dtype, int(count), self.used)
        self.used += size
        return values


def _take_rows(path, payload):
    rows = _Payload(path, payload)
    _, count = rows.take("<u4", 2)
    entries, visibilities = rows.take("<u8", 2)
    return {"begin": rows.take("<u8", count + 1), "environment": rows.take("<f8", count),
            "blocked": rows.take("<f8", count), "columns": rows.take("<u4", entries),
            "values": rows.take("<f4", entries), "visibility": rows.take("u1", visibilities),
            "known": rows.take("u1", count).astype(bool)}


def _take_clusters(path, payload, size):
    """What shares factors to patches and clusters, columns from `size` on, out among the patches by weight."""
    tree = _Payload(path, payload)
    order = tree.take("<u4", size)
    nodes = tree.take("<u4", 3 * (2 * size - 1)).reshape(-1, 3)
    weights = tree.take("<f8", size)
    begin, end = nodes[:, 0].astype(numpy.int64), nodes[:, 1].astype(numpy.int64)

    def spread(columns):
        """A row for every one of `columns`, its shares of the patches."""
        is_node = columns >= size
        node = columns[is_node] - size
        first = numpy.zeros(len(columns), numpy.int64)
        last = numpy.ones(len(columns), numpy.int64)
        first[is_node], last[is_node] = begin[node], end[node]
        count = last - first
        offsets = numpy.concatenate([[0], numpy.cumsum(count)])
        within = numpy.arange(offsets[-1]) - numpy.repeat(offsets[:-1], count) + numpy.repeat(first, count)
        patches = numpy.where(numpy.repeat(is_node, count), order[within], numpy.repeat(columns, count))
        weight = numpy.where(numpy.repeat(is_node, count), weights[patches], 1.0)
        row = numpy.repeat(numpy.arange(len(columns)), count)
        sums = numpy.bincount(row, weight, len(columns))
        share = weight / numpy.where(sums > 0.0, sums, 1.0)[row]
        return scipy.sparse.csr_matrix((share, (row, patches)), shape=(len(columns), size))

    return spread


def read_hff(path):
    """The Factors in a `.hff`, of single patches: factors to clusters are shared out by weight.

    Raises FileError if it is none.
    """
    head, areas, group_of, patch_of, spread, blocks = None, None, None, None, None, []
    for tag, payload in _chunks(path, b"HEMIFF\r\n", 4):
        if tag == b"HEAD":
            head = json.loads(payload)
        elif tag == b"AREA":
            areas = _Payload(path, payload).take("<f8", head["size"])
        elif tag == b"GRUP":
            group_of = _Payload(path, payload).take("<u4", head["size"])
        elif tag == b"PART":
            patch_of = _Payload(path, payload).take("<u4", head["size"])
        elif tag == b"TREE":
            spread = _take_clusters(path, payload, head["size"])
        elif tag == b"ROWS":
            blocks.append(_take_rows(path, payload))
    size = head["size"]

    def joined(name, dtype):
        return numpy.concatenate([block[name] for block in blocks] or [numpy.empty(0, dtype)])

    begin = numpy.zeros(size + 1, numpy.int64)
    begin[1:] = numpy.cumsum(numpy.concatenate(
        [numpy.diff(block["begin"].astype(numpy.int64)) for block in blocks] or [numpy.empty(0, numpy.int64)]))
    values = joined("values", "<f4")
    visibility = joined("visibility", "u1")
    columns = joined("columns", "<u4").astype(numpy.int64)
    if spread is None:
        factors = scipy.sparse.csr_matrix((values, columns, begin), shape=(size, size))
    else:
        used, place = numpy.unique(columns, return_inverse=True)
        factors = (scipy.sparse.csr_matrix((values, place, begin), shape=(size, len(used)))
                   @ spread(used)).astype("<f4")
        visibility = numpy.empty(0, "u1")  # clusters have none of single patches
    return Factors(
        factors=factors,
        visibility=visibility if len(visibility) == len(values) else None,
        known=joined("known", bool), environment=joined("environment", "<f8"), blocked=joined("blocked", "<f8"),
        areas=areas, groups=head["groups"], group_of=group_of,
        settings={name: value for name, value in head.items() if name not in ("size", "groups", "block_rows")},
        patch_of=patch_of)


def read_factors(path):
    """F of patches, a scipy.sparse.csr_matrix, from `.hff` (as computed), `.npz`, `.mtx` or `.csv` (all repaired)."""
    extension = str(path).rsplit(".", 1)[-1].lower()
    if extension == "hff":
        return read_hff(path).by_patch()
    if extension == "npz":
        return scipy.sparse.load_npz(path)
    if extension == "mtx":
        return scipy.io.mmread(path).tocsr()
    if extension == "csv":
        triples = numpy.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
        size = int(triples[:, :2].max()) + 1
        columns = (triples[:, 2], (triples[:, 0].astype(int), triples[:, 1].astype(int)))
        return scipy.sparse.csr_matrix(columns, shape=(size, size))
    raise FileError(f"{path}: form factors end in .hff, .npz, .mtx or .csv")


def read_table(path):
    """A table of patches (`--patches`, `--radiosity`): column name -> array, `group` as text, all else float64."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows or rows[0][:2] != ["index", "group"]:
        raise FileError(f"{path}: is no table of patches: its first line must begin with index,group")
    columns = list(zip(*rows[1:])) or [()] * len(rows[0])
    return {name: numpy.array(values, dtype=str if name == "group" else numpy.float64)
            for name, values in zip(rows[0], columns)}


def read_json(path):
    """What `--json` printed, its lists of numbers as arrays."""
    with open(path, encoding="utf-8") as file:
        document = json.load(file)

    def convert(value):
        if isinstance(value, dict):
            return {name: convert(item) for name, item in value.items()}
        if isinstance(value, list):
            try:
                array = numpy.array(value, dtype=numpy.float64)
            except (TypeError, ValueError):
                return [convert(item) for item in value]
            return array if array.size else value
        return value

    return convert(document)
