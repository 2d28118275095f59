"""What the benchmarks' Python measurements share. Import it before numpy: from then on libraries take one thread."""

import os
import time

for library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"


def timed(solve, *arguments):
    """What it gives and median of the processor time: three runs and a tenth of a second at least, but one of a second."""
    seconds = []
    while not seconds or (sum(seconds) < 1 and (len(seconds) < 3 or sum(seconds) < 0.1)):
        begun = time.process_time()
        result = solve(*arguments)
        seconds.append(time.process_time() - begun)
    return result, sorted(seconds)[len(seconds) // 2]
