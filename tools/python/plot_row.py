#!/usr/bin/env python3
"""Plots one row of F: where what leaves a patch goes. The worked example of hemi_files.

    hemi factors scenes/cornell-box.json -o box.hff --patches patches.csv
    tools/python/plot_row.py box.hff patches.csv --row 1234 -o row.png

Needs python3-matplotlib.
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as pyplot
import numpy

import hemi_files


def main():
    parser = argparse.ArgumentParser(description="Plots one row of F against distance, a colour a group.")
    parser.add_argument("factors", help="form factors: .hff, .npz, .mtx or .csv")
    parser.add_argument("patches", help="what --patches FILE.csv wrote")
    parser.add_argument("--row", type=int, required=True, help="index of the patch that light leaves, from 0")
    parser.add_argument("-o", dest="output", default="row.png", help="picture to write (row.png)")
    arguments = parser.parse_args()

    row = hemi_files.read_factors(arguments.factors)[arguments.row]
    patches = hemi_files.read_table(arguments.patches)
    centres = numpy.stack([patches["cx"], patches["cy"], patches["cz"]], axis=1)
    distances = numpy.linalg.norm(centres[row.indices] - centres[arguments.row], axis=1)
    groups = patches["group"][row.indices]
    order = sorted(set(groups), key=lambda name: -row.data[groups == name].sum())

    figure, axes = pyplot.subplots(figsize=(8, 5))
    for name in order:
        here = groups == name
        axes.plot(distances[here], row.data[here], ".", markersize=3,
                  label=f"{name}: {row.data[here].sum():.3f}")
    axes.set_yscale("log")
    axes.set_xlabel("distance between centres, scene units")
    axes.set_ylabel(f"F({arguments.row}, j)")
    axes.set_title(f"Where what leaves patch {arguments.row} ({patches['group'][arguments.row]}) goes: "
                   f"{row.data.sum():.3f} in all")
    axes.legend(markerscale=4, fontsize="small")
    figure.tight_layout()
    figure.savefig(arguments.output, dpi=120)


if __name__ == "__main__":
    main()
