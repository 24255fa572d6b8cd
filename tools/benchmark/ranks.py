#!/usr/bin/python3
"""How well ranks share the work: the program by 1, 2 ... ranks on this machine, each on a core of its own.

ranks.py MPIEXEC PROGRAM SCENE... ; called by tools/bench --mpi. Prints seconds of the stages, those that the processors
of all ranks worked, the memory of the largest rank, and the efficiency: the time of one rank over that of R ranks times R.
Processor time says what is done more than once, also where others use the machine.
"""
import json
import os
import subprocess
import sys
import tempfile

ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "core",  # threads of a rank stay on its core
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}
STAGES = ("factors", "repair", "solve", "estimate")


def measure(mpiexec, program, ranks, scene):
    """Seconds of the stages, of the processors, and the peak of the largest process in bytes."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        command = [mpiexec, "-n", str(ranks), program, "solve", scene, "--device", "cpu", "--json", "--gather", "off"]
        process = subprocess.Popen(command, stdout=out, stderr=err, env=os.environ | ENVIRONMENT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        text = out.read()
        if not text:
            sys.exit(f"bench: {' '.join(command)} failed: {err.read().decode()}")
        return json.loads(text)["seconds"], usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def main():
    mpiexec, program, *scenes = sys.argv[1:]
    cores = len(os.sched_getaffinity(0))
    print(f"{'scene':<16} {'ranks':>5} " + " ".join(f"{stage + ' s':>10}" for stage in STAGES) +
          f" {'all s':>8} {'processor s':>11} {'MiB a rank':>10} {'efficiency':>10}")
    for scene in scenes:
        alone = None
        for ranks in range(1, cores + 1):
            seconds, processor, memory = measure(mpiexec, program, ranks, scene)
            spent = sum(seconds[stage] for stage in STAGES)
            alone = alone or spent
            print(f"{os.path.basename(scene):<16} {ranks:>5} " +
                  " ".join(f"{seconds[stage]:>10.2f}" for stage in STAGES) +
                  f" {spent:>8.2f} {processor:>11.2f} {memory / 2**20:>10.0f} {alone / (ranks * spent):>10.2f}",
                  flush=True)


main()
