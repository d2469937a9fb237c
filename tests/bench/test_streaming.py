"""A million rows into a file: memory flat, and at least 200,000 rows a second of CPU time for the recording part.

Each size runs in a process of its own, so that the peak of one does not hide in that of the other.
"""

import json
import subprocess
import sys

PROGRAM = """
import json, resource, sys, time
import sailviz
from sailviz.recording import Recorder
from sailviz.simulation import simulate_blocks

scene = sailviz.load_scene("spirals/optical-sail").with_values(
    {"propagation.outputs": int(sys.argv[1]), "propagation.duration_d": 760, "event": [], "expect": []}
)
recording = simulating = 0.0
with Recorder(sys.argv[2]) as recorder:
    blocks = simulate_blocks(scene)
    while True:
        start = time.thread_time()
        block = next(blocks, None)
        simulating += time.thread_time() - start
        start = time.process_time()
        if block is None:
            recorder.finish()
            recording += time.process_time() - start
            break
        recorder.add(block)
        recording += time.process_time() - start
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps({"peak_MB": peak, "recording_s": recording, "simulating_s": simulating}))
"""


def stream(rows, file):
    done = subprocess.run([sys.executable, "-c", PROGRAM, str(rows), str(file)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_million_rows_stream_with_flat_memory(tmp_path, record_property, capsys):
    stream(3_000, tmp_path / "warm.rrd")  # compiles, and fills the file cache
    small = stream(3_000, tmp_path / "small.rrd")
    large = stream(1_000_000, tmp_path / "large.rrd")
    rate = 1_000_000 / large["recording_s"]
    with capsys.disabled():
        print(
            f"\n1e6 rows: {rate:,.0f} rows/s of CPU, simulated in {large['simulating_s']:.2f} s of CPU, peak ", end=""
        )
        print(f"{large['peak_MB']:.0f} MB against {small['peak_MB']:.0f} MB for 3,000 rows")
    assert large["peak_MB"] - small["peak_MB"] < 200
    assert rate >= 200_000
