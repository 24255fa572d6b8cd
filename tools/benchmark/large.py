#!/usr/bin/python3
"""What large scenes cost from file to picture: the whole of `solve`, with its picture, its files and its errors.

large.py PROGRAM BENCH FOLDER SCENE... ; called by tools/bench --large. Prints seconds of the stages, those that the
processors worked, the peak of memory, and the printed errors of the reflected light: all of it as pictures show it, and
the parts of the patches' size and of the form factors; and frames a second of the window while the camera moves, by the
OpenGL device that there is. A scene whose name begins with `bumpy` is closed, and a fiftieth of its
triangles are lamps; others lie under a bright sky. Pictures are left in FOLDER, to be looked at.
"""
import json
import os
import subprocess
import sys
import tempfile

STAGES = ("load", "factors", "repair", "solve", "gather", "estimate", "render")


def count_triangles(scene):
    with open(scene, encoding="ascii") as lines:
        return sum(line.startswith("f ") for line in lines)


def write_lamps(path, triangles):
    with open(path, "w", encoding="ascii") as file:
        file.write("index,exitance\n")
        file.writelines(f"{face},100\n" for face in range(triangles // 50))


def measure(program, folder, scene):
    """What `solve --json` says, processor seconds, and the peak of the process in bytes."""
    name = os.path.splitext(os.path.basename(scene))[0]
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        light = ["--environment", "1"]
        if name.startswith("bumpy"):
            lamps = os.path.join(scratch, "lamps.csv")
            write_lamps(lamps, count_triangles(scene))
            light = ["--exitance-from", lamps]
        command = [program, "solve", scene, *light, "--json", "-o", os.path.join(folder, f"{name}.png"),
                   "--radiosity", os.path.join(scratch, "radiosity.csv"),
                   "--patches", os.path.join(scratch, "patches.csv")]
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            process = subprocess.Popen(command, stdout=out, stderr=err)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            err.seek(0)
            text = out.read()
            if process.returncode != 0 or not text:
                sys.exit(f"bench: {' '.join(command)} failed: {err.read().decode()}")
            return json.loads(text), usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def frames(bench, scene):
    """Frames a second of the window while it moves, 1280 x 720."""
    said = subprocess.run([bench, "--frames", "auto", scene], check=True, capture_output=True, text=True).stdout
    return 1.0 / float(said.split()[0])


def percent(value):
    return "-" if value is None else f"{100 * value:.3g} %"


def main():
    program, bench, folder, *scenes = sys.argv[1:]
    print(f"{'scene':<16} {'patches':>9} " + " ".join(f"{stage + ' s':>10}" for stage in STAGES) +
          f" {'all s':>8} {'processor s':>11} {'GiB':>6} {'error':>8} {'size':>8} {'factors':>8} {'frames/s':>8}", flush=True)
    for scene in scenes:
        said, processor, memory = measure(program, folder, scene)
        seconds = said["seconds"]
        error = said["error"] or {}
        parts = error.get("parts") or {}
        print(f"{os.path.basename(scene):<16} {said['patches']:>9} " +
              " ".join(f"{seconds.get(stage, 0.0):>10.1f}" for stage in STAGES) +
              f" {seconds['total']:>8.1f} {processor:>11.1f} {memory / 2**30:>6.2f}"
              f" {percent((error.get('vertices') or {}).get('rms')):>8} {percent(parts.get('patch_size')):>8}"
              f" {percent(parts.get('factors')):>8} {frames(bench, scene):>8.1f}", flush=True)


main()
