"""Promise: a sweep's file has the same bytes from Python, from Ray and from the program."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import tumble
import tumble.double

VARY = {"bodies.0.angular_velocity.1": (0.0, 5.0), "bodies.0.angular_velocity.2": "normal(0,0.01)"}


def small(worlds: float = 100, **options: object) -> tumble.Sweep:
    return tumble.sweep("t-handle", VARY, worlds=worlds, seed=7, steps=40, **options)


def test_a_file_is_that_of_the_program_to_the_byte(tmp_path: Path, program: Path) -> None:
    ours = small(observe="max(t-handle.wy)").run(tmp_path / "ours.csv").read_bytes()
    theirs = tmp_path / "theirs.csv"
    command = [program, "sweep", "t-handle", "--worlds", "100", "--seed", "7", "--steps", "40", "--quiet"]
    command += ["--vary", "bodies.0.angular_velocity.1=0..5", "--vary", "bodies.0.angular_velocity.2=normal(0,0.01)"]
    subprocess.run([*command, "--observe", "max(t-handle.wy)", "--out", theirs], check=True)
    assert ours == theirs.read_bytes()
    assert ours.count(b"\n") == 102


def test_the_file_does_not_depend_on_threads_or_on_where_it_was_interrupted(tmp_path: Path) -> None:
    whole = small().run(tmp_path / "whole.csv").read_bytes()
    threads = tumble.threads()
    try:
        for count in (1, 3):
            tumble.set_threads(count)
            assert small().run(tmp_path / f"{count}.csv").read_bytes() == whole
    finally:
        tumble.set_threads(threads)
    # Cut anywhere, within a line too, the same call goes on.
    for end in (0, 10, whole.index(b"\n") + 1, len(whole) // 2, len(whole) - 1):
        part = tmp_path / "part.csv"
        part.write_bytes(whole[:end])
        assert small().run(part).read_bytes() == whole, end


def test_rows_are_those_of_any_part(tmp_path: Path) -> None:
    sweep = small()
    assert len(sweep) == sweep.worlds == 100
    assert sweep.rows(0, 100) == sweep.rows(0, 37) + sweep.rows(37, 38) + sweep.rows(38, 100)
    assert sweep.rows(5, 5) == b""
    for start, stop in ((3, 2), (0, 101)):
        with pytest.raises(tumble.ArgumentError, match="among 100"):
            sweep.rows(start, stop)
    line = sweep.rows(4, 5).decode().rstrip("\n").split(",")
    assert line[0] == "4" and len(line) == len(sweep.columns)


def test_values_are_texts_ends_and_lists() -> None:
    as_text = tumble.sweep("t-handle", {"gravity.1": "list(-1.0,0.5)"}, steps=5)
    as_list = tumble.sweep("t-handle", {"gravity.1": [-1, 0.5]}, steps=5)
    assert as_list.worlds == 2 and as_list.rows(0, 2) == as_text.rows(0, 2)
    ends = tumble.sweep("t-handle", {"gravity.1": (-1, 0.5)}, worlds=1e1, steps=5)
    assert ends.rows(0, 10) == tumble.sweep("t-handle", {"gravity.1": "-1..0.5"}, worlds=10, steps=5).rows(0, 10)


def test_double_precision_is_another_sweep(tmp_path: Path) -> None:
    path = small().run(tmp_path / "file.csv")
    before = path.read_bytes()
    other = tumble.double.sweep("t-handle", VARY, worlds=100, seed=7, steps=40)
    with pytest.raises(tumble.SweepFileError, match="precision"):
        other.run(path)
    assert path.read_bytes() == before
    assert b"f64" in other.run(tmp_path / "double.csv").read_bytes().splitlines()[0]


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"vary": {"bodies.0.masss": (1, 2)}, "worlds": 3}, "bodies.0.masss"),
        ({"vary": {"gravity.1": (2, 1)}, "worlds": 3}, "vary"),
        ({"vary": {"gravity.1": (1, 2, 3)}, "worlds": 3}, "vary['gravity.1']"),
        ({"vary": {"gravity.1": (1, 2)}}, "worlds"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": -1}, "worlds"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 0}, "worlds"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2.5}, "worlds"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "dt": -1.0}, "dt"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "steps": 3, "duration": 1.0}, "duration"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "integrator": "leapfrog"}, "integrator"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "bodies": "nobody"}, "bodies"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "until": "nobody.py<0"}, "until"),
        ({"vary": {"gravity.1": (1, 2)}, "worlds": 2, "precision": "f16"}, "precision"),
        ({"vary": {"gravity.1": "1..x"}, "worlds": 2}, "vary"),
    ],
)
def test_what_cannot_be_names_the_argument(arguments: dict[str, object], field: str) -> None:
    with pytest.raises(tumble.ArgumentError) as raised:
        tumble.sweep("t-handle", **arguments)  # type: ignore[arg-type]
    assert field in raised.value.field or field in str(raised.value)


def test_a_wrong_file_stays_as_it_is(tmp_path: Path) -> None:
    letter = tmp_path / "letter.csv"
    letter.write_text("Dear reader\n")
    with pytest.raises(tumble.SweepFileError, match="letter.csv"):
        small().run(letter)
    assert letter.read_text() == "Dear reader\n"
    with pytest.raises(tumble.ArgumentError, match=".csv"):
        small().run(tmp_path / "file.txt")
    with pytest.raises(OSError):
        small().run(tmp_path / "no folder" / "file.csv")


def test_ctrl_c_leaves_whole_rows_and_the_same_call_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "long.csv"
    code = f"""
import tumble
try:
    tumble.sweep("t-handle", {VARY!r}, worlds=2000, seed=7, steps=4000).run({str(out)!r}, progress=print)
except KeyboardInterrupt:
    print("interrupted")
"""
    running = subprocess.Popen([sys.executable, "-u", "-c", code], stdout=subprocess.PIPE, text=True)
    assert running.stdout
    first = running.stdout.readline()
    assert first.split()[1] == "2000"
    running.send_signal(signal.SIGINT)
    rest, _ = running.communicate(timeout=60)
    assert rest.splitlines()[-1] == "interrupted", rest
    rows = out.read_bytes()
    assert rows.endswith(b"\n") and 3 <= rows.count(b"\n") < 2002
    # The rows there are the first ones of the sweep.
    sweep = tumble.sweep("t-handle", VARY, worlds=2000, seed=7, steps=4000)
    first_rows = rows.split(b"\n", 2)[2].splitlines(keepends=True)[:3]
    assert b"".join(first_rows) == sweep.rows(0, 3)


def test_a_sweep_can_be_pickled() -> None:
    sweep = small()
    copy = pickle.loads(pickle.dumps(sweep))
    assert copy.rows(3, 6) == sweep.rows(3, 6)
    assert repr(copy) == repr(sweep) and "100 worlds" in repr(sweep)


@pytest.fixture(scope="module")
def cluster() -> object:
    ray = pytest.importorskip("ray", reason="Ray is an optional dependency")
    os.environ["RAY_ENABLE_UV_RUN_RUNTIME_ENV"] = "0"
    ray.init(num_cpus=3, log_to_driver=False, include_dashboard=False)
    yield ray
    ray.shutdown()


def test_ray_gives_the_same_bytes(tmp_path: Path, cluster: object) -> None:
    here = small(worlds=500).run(tmp_path / "here.csv").read_bytes()
    calls: list[int] = []
    there = small(worlds=500).on_ray(tmp_path / "there.csv", block=17, progress=lambda done, _: calls.append(done))
    assert there.read_bytes() == here
    assert calls == sorted(calls) and calls[-1] == 500
    part = tmp_path / "part.csv"
    part.write_bytes(here[: len(here) // 3])
    assert small(worlds=500).on_ray(part).read_bytes() == here


def test_ray_survives_a_worker_that_is_killed(tmp_path: Path, cluster: object) -> None:
    sweep = tumble.sweep("t-handle", VARY, worlds=300, seed=1, steps=2000)
    here = sweep.run(tmp_path / "here.csv").read_bytes()
    killed: list[int] = []

    def kill(done: int, _: int) -> None:
        # A worker of ours that is at a task has its name.
        if len(killed) < 2:
            listing = subprocess.run(["ps", "-eo", "pid,args"], capture_output=True, text=True, check=True).stdout
            workers = [int(line.split()[0]) for line in listing.splitlines() if "ray::_rows" in line]
            if workers:
                os.kill(workers[0], signal.SIGKILL)
                killed.append(workers[0])

    assert sweep.on_ray(tmp_path / "there.csv", block=5, progress=kill).read_bytes() == here
    assert killed, "no worker was found to be killed"
