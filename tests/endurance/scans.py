"""Scans of the virtual bench that are interrupted, gone on with, and compared with one that nothing interrupted."""

import dataclasses
import os
import random
import shutil
import subprocess
import sys
import time

from datasets import contents, difference, journal, lost_cells, parsed, written_ns

patience_s = 180  # for one scan, on a machine that is busy


class Bench:
    """The virtual bench while it runs, in a process group of its own; `file` is its bench file."""

    def __init__(self, build, folder, *options):
        command = [build / "lumifield-bench", "--seed", "5", "--filter", "bell:24:2", "--stage-speed", "5000",
                   "--stage-acceleration", "100000", *options, "--", "sh", "-c", 'echo "$LUMIFIELD_BENCH"; exec cat >/dev/null']
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        process_group=0, env={**os.environ, "TMPDIR": str(folder)})
        self.file = self.process.stdout.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(patience_s)
        self.process.stdout.close()


class Scan:
    """A scan that runs, in the bench's process group."""

    def __init__(self, command, bench, said_in):
        self.said_in = said_in
        with open(said_in, "w") as said:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said, text=True,
                                            process_group=bench.process.pid)

    def ends_within(self, seconds):
        try:
            self.process.communicate(timeout=seconds)
            return True
        except subprocess.TimeoutExpired:
            return False

    def wait_for(self, word):
        """Whether it said so before it ended."""
        return any(line.strip() == word for line in self.process.stdout)

    def wait_for_cells(self, dataset, cells):
        while len(journal(dataset)) < cells and self.process.poll() is None:
            time.sleep(0.005)

    def line_with(self, words):
        """What it said on stderr with these words."""
        return next((line for line in self.said_in.read_text().splitlines() if words in line), "")

    def wait_for_line(self, words):
        """The same, empty if it ends before it says so."""
        while self.process.poll() is None and not self.line_with(words):
            time.sleep(0.02)
        return self.line_with(words)

    def kill(self):
        self.process.kill()
        self.process.communicate()

    def said(self):
        """Its error; how many cells are kept stands after it."""
        lines = [line for line in self.said_in.read_text().splitlines()
                 if line.startswith("lumifield: ") and "cells are kept" not in line]
        return lines[-1].removeprefix("lumifield: ") if lines else ""

    def wrong_end(self, code, words=""):
        """What is wrong about how it ended, if it has not ended with this code and these words."""
        if not self.ends_within(patience_s):
            self.kill()
            return "it does not end"
        if self.process.returncode != code:
            return f"exit code {self.process.returncode}: {self.said()}"
        return "" if words in self.said() else f"does not say '{words}' but '{self.said()}'"


@dataclasses.dataclass
class Row:
    fault: str
    at_s: float | None  # of a kill
    ended_s: float | None  # of a fault of the disk: from the fault's first sign to the program's end
    durable: int
    lost: int
    resumed_s: float | None  # nothing where the scan went on by itself
    differs: str
    said: str
    wrong: str
    must_lose: bool = False  # a store whose flushes do nothing

    def failed(self):
        return bool(self.lost) != self.must_lose or bool(self.differs or self.wrong)

    def __str__(self):
        text = self.fault
        for word, figure in (("at", self.at_s), ("ended in", self.ended_s), ("resumed in", self.resumed_s)):
            text += f", {word} {figure:.3f} s" if figure is not None else ""
        text += f": {self.durable} durable, {self.lost} lost, "
        wrong = self.wrong and f"WRONG: {self.wrong}"
        as_due = ("as it must" if self.lost else "NOT SEEN") if self.must_lose else "identical"
        return text + "; ".join(filter(None, [self.differs or as_due, self.said, wrong]))


class Trials:
    def __init__(self, build, source, folder, seed):
        self.build, self.folder = build, folder
        self.plan = source / "tests/endurance/plan.json"
        self.random = random.Random(seed)
        self.rows, self.datasets, self.troubles = [], 0, 0
        while not self.measure_whole():
            pass

    def bench(self, *options):
        return Bench(self.build, self.folder, *options)

    def new_dataset(self, disk=None):
        self.datasets += 1
        folder = (disk or self.folder) / f"{self.datasets:03}"
        folder.mkdir()
        return folder / "lamp.lumi"

    def begin(self, command, bench, dataset):
        return Scan(command, bench, self.folder / f"{dataset.parent.name}.said")

    def scan(self, bench, dataset, *under):
        command = [*under, self.build / "lumifield", "scan", "--bench", bench.file, "--plan", self.plan]
        return self.begin(command + ["--out", dataset] + ["--resume"] * dataset.exists(), bench, dataset)

    def retaking_scan(self, bench, dataset):
        return self.begin([self.build / "tests/retaking_scan", bench.file, self.plan, dataset], bench, dataset)

    def difference(self, dataset, retaken):
        return difference(dataset, self.reference, self.build / "tests/same_pixels", retaken)

    def troubled(self, scan):
        """Whether the bench failed it: on a machine that is too busy the camera's frames come too late."""
        trouble = scan.process.returncode == 1 and ("camera " in scan.said() or "stage " in scan.said())
        if trouble:
            self.troubles += 1
            print(f"     once more, the bench was too slow: {scan.said()}", file=sys.stderr, flush=True)
        return trouble

    def ended_early(self, scan):
        """A scan that ended before its fault came: done, or troubled."""
        if scan.wrong_end(0) and not self.troubled(scan):
            sys.exit(f"a scan that nothing disturbed ends with {scan.process.returncode}: {scan.said()}")

    def measure_whole(self):
        """The uninterrupted scan, and how long it takes. False when the bench failed it."""
        self.reference = self.new_dataset()
        with self.bench() as bench:
            start = time.monotonic()
            whole = self.scan(bench, self.reference)
            self.ended_early(whole)
            self.whole_s = time.monotonic() - start
        return whole.process.returncode == 0

    def measure_retaking(self):
        """The same with cells taken again, and how long that and closing take."""
        retaken = self.new_dataset()
        with self.bench() as bench:
            scan = self.retaking_scan(bench, retaken)
            at = [time.monotonic() for word in ("retaking", "retaken", "closing") if scan.wait_for(word)]
            self.ended_early(scan)
        if scan.process.returncode != 0:
            return False
        self.retaking_s, self.closing_s = at[1] - at[0], time.monotonic() - at[2]
        if differs := self.difference(retaken, retaken=True):
            sys.exit(f"cells taken again are others: {differs}")
        return True

    def finish(self, fault, dataset, durable, bench, wrong="", **told):
        """Goes on with the scan, and judges what came of it. A cell that was lost is taken again to the bit: so what
        was lost is looked for before."""
        lost, written = lost_cells(durable, dataset), written_ns(durable, dataset)
        start = time.monotonic()
        scan = self.scan(bench, dataset)
        while (resumed_wrong := scan.wrong_end(0)) and self.troubled(scan):
            scan = self.scan(bench, dataset)
        resumed_s = time.monotonic() - start
        after = written_ns(durable, dataset)
        lost |= {cell for cell in durable if after.get(cell) != written.get(cell)}
        self.judge(fault, dataset, durable, wrong or resumed_wrong, lost, resumed_s=resumed_s, **told)

    def judge(self, fault, dataset, durable, wrong, lost=frozenset(), at_s=None, ended_s=None, resumed_s=None, said="",
              retaken=False):
        whole = parsed(contents(dataset / "luminaire.json"))
        differs = self.difference(dataset, retaken) if whole else "no manifest"
        self.keep(Row(fault, at_s, ended_s, len(durable), len(lost | lost_cells(durable, dataset)), resumed_s, differs,
                      said.replace(f"{dataset.parent}/", ""), wrong), dataset)

    def expect_loss(self, fault, dataset, durable, wrong):
        """Of a store whose flushes do nothing."""
        lost = len(lost_cells(durable, dataset))
        self.keep(Row(fault, None, None, len(durable), lost, None, "", "", wrong, must_lose=True), dataset)

    def keep(self, row, dataset):
        self.rows.append(row)
        print(f"{len(self.rows):4} {row}", file=sys.stderr, flush=True)
        if row.failed():
            shutil.copytree(dataset.parent, self.folder / f"failed_{len(self.rows)}")
        shutil.rmtree(dataset.parent)
