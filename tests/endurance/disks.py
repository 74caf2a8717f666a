"""Disks that fill, fail, turn read-only and lose their power under a scan."""

import contextlib
import fcntl
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time

from datasets import durable_cells, half_cells, journal
from scans import Row

# Of the plan's twelve cells in serpentine order.
in_mid_scan, cell_in_mid_scan = 5, "cells/r01_c01.1.exr.tmp"


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def mount(undo, target, *options):
    target.mkdir(exist_ok=True)
    run("mount", *options, target)
    undo.callback(run, "umount", target)
    return target


def fails(trials, fault, scan, dataset, words, bench, durable=None, repair=lambda: None, must_lose=False):
    """A scan whose disk fails now: it ends with an error that says what, and goes on after the repair.
    False when the bench failed it first."""
    start = time.monotonic()
    wrong = scan.wrong_end(1, words)
    if wrong and trials.troubled(scan):
        return False
    ended_s = time.monotonic() - start
    if durable is None:
        durable = durable_cells(dataset)
    if not wrong and not durable:
        wrong = "no cell was durable before the fault"
    repair()
    if must_lose:
        trials.expect_loss(fault, dataset, durable, wrong)
        return True
    trials.finish(fault, dataset, durable, bench, ended_s=ended_s, said=scan.said(), wrong=wrong)
    return True


def full(trials, undo):
    """The scan waits, and goes on by itself once there is room."""
    disk = mount(undo, trials.folder / "full", "-t", "tmpfs", "-o", "size=256k", "none")
    dataset = trials.new_dataset(disk)
    with trials.bench() as bench:
        scan = trials.scan(bench, dataset)
        waits = scan.wait_for_line("storing waits")
        if not waits and trials.troubled(scan):
            return False
        durable = durable_cells(dataset)
        ended = scan.ends_within(1.2)  # it looks for room every half second
        run("mount", "-o", "remount,size=8m", disk)
        start = time.monotonic()
        wrong = scan.wrong_end(0)
        if wrong and trials.troubled(scan):
            return False
        ended_s = time.monotonic() - start
    if ended or not durable or not scan.line_with("storing goes on"):
        wrong = wrong or "it did not wait for room"
    trials.judge("full: tmpfs of 256 KiB", dataset, durable, wrong, ended_s=ended_s, said=waits)
    return True


def read_only(trials, undo):
    disk = mount(undo, trials.folder / "read_only", "-t", "tmpfs", "none")
    dataset = trials.new_dataset(disk)
    with trials.bench() as bench:
        scan = trials.scan(bench, dataset)
        scan.wait_for_cells(dataset, in_mid_scan)
        # Refused while a file is being written.
        while subprocess.run(["mount", "-o", "remount,ro", disk], stderr=subprocess.DEVNULL).returncode != 0:
            time.sleep(0.002)
        return fails(trials, "read-only of a sudden", scan, dataset, "Read-only file system", bench,
                     repair=lambda: run("mount", "-o", "remount,rw", disk))


def durable_flushed(dataset):
    """Without the last line, which may not have been flushed yet."""
    return durable_cells(dataset, max(0, len(journal(dataset)) - 1))


def ext4_image(image):
    """A file with an ext4 of 24 MiB, to be mounted through a loop device."""
    with open(image, "wb") as file:
        file.truncate(24 << 20)
    run("mkfs.ext4", "-q", "-F", image)
    return image


def full_beneath(trials, undo):
    """A file system whose own disk is full: every write succeeds, the flush does not, and it turns read-only."""
    beneath = mount(undo, trials.folder / "beneath", "-t", "tmpfs", "-o", "size=32m", "none")
    image = ext4_image(beneath / "image")
    room = image.stat().st_blocks * 512 + 400 * 1024
    run("mount", "-o", f"remount,size={room}", beneath)
    disk = mount(undo, trials.folder / "thin", "-o", "loop", image)
    dataset = trials.new_dataset(disk)

    def repair():
        run("mount", "-o", "remount,size=32m", beneath)
        run("umount", disk)
        # 0: clean, 1: repaired
        if (code := subprocess.run(["e2fsck", "-fp", image], stdout=subprocess.DEVNULL).returncode) > 1:
            sys.exit(f"e2fsck does not repair the thin disk: {code}")
        run("mount", "-o", "loop", image, disk)

    with trials.bench() as bench:
        scan = trials.scan(bench, dataset)
        scan.wait_for_cells(dataset, in_mid_scan)
        return fails(trials, "full beneath: ext4 on a thin disk", scan, dataset, "", bench, durable_flushed(dataset),
                     repair)


class PowerDisk:
    """An ext4 with a new dataset's folder, whose power can be cut: it stops at once, and what was not flushed is gone."""

    def __init__(self, trials, undo):
        self.image = ext4_image(trials.folder / "power.image")
        undo.callback(self.image.unlink)
        self.folder = mount(undo, trials.folder / "power", "-o", "loop", self.image)
        self.dataset = trials.new_dataset(self.folder)
        run("sync", "-f", self.folder)

    def cut(self):
        shut_down, without_log = 0x8004587D, struct.pack("I", 2)  # EXT4_IOC_SHUTDOWN, EXT4_GOING_FLAGS_NOLOGFLUSH
        folder = os.open(self.folder, os.O_RDONLY)
        fcntl.ioctl(folder, shut_down, without_log)
        os.close(folder)

    def repair(self):
        run("umount", self.folder)
        run("mount", "-o", "loop", self.image, self.folder)  # replays the file system's own journal
        run("umount", self.folder)
        run("e2fsck", "-fn", self.image)
        run("mount", "-o", "loop", self.image, self.folder)


def power_cut(fault="power cut: ext4 shut down", unflushed=None):
    """Flushing the files `unflushed`, all if empty, does nothing: then cells must be lost, or nothing shows here that
    they would be."""

    def trial(trials, undo):
        disk = PowerDisk(trials, undo)
        dataset = disk.dataset
        must_lose = unflushed is not None
        under = traced([dataset / file for file in unflushed], "fsync", "retval=0") if must_lose else []
        with trials.bench() as bench:
            scan = trials.scan(bench, dataset, *under)
            scan.wait_for_cells(dataset, in_mid_scan)
            time.sleep(trials.random.uniform(0, trials.whole_s / 4))
            durable = durable_flushed(dataset)
            disk.cut()
            return fails(trials, fault, scan, dataset, "Input/output error", bench, durable, disk.repair, must_lose)

    return trial


def power_cut_by_hand(fault="power cut amid a slide that was changed by hand", unflushed=False):
    """The same for half cells: the scan goes on, and waits for the next slide with all of this one's."""

    def trial(trials, undo):
        disk = PowerDisk(trials, undo)
        dataset = disk.dataset
        with trials.bench("--change", "operator", "--size", "512x384") as bench:
            scan = trials.scan(bench, dataset, *(traced([], "fsync", "retval=0") if unflushed else []))
            while len(durable := half_cells(dataset)) <= in_mid_scan and scan.process.poll() is None:
                time.sleep(0.005)
            newest = max(durable, key=lambda name: (dataset / "halves" / name).stat().st_mtime_ns, default=None)
            durable.pop(newest, None)  # its folder may not have been flushed yet
            disk.cut()
            start = time.monotonic()
            wrong = scan.wrong_end(1, "Input/output error")
            if wrong and trials.troubled(scan):
                return False
            ended_s, said = time.monotonic() - start, scan.said()
            disk.repair()
            lost = {name for name, sha256 in durable.items() if half_cells(dataset).get(name) != sha256}
            if unflushed:
                trials.keep(Row(fault, None, None, len(durable), len(lost), None, "", "", wrong, must_lose=True), dataset)
                return True
            start = time.monotonic()
            scan = trials.scan(bench, dataset)
            while (wrong_end := scan.wrong_end(3)) and trials.troubled(scan):
                scan = trials.scan(bench, dataset)
            resumed_s = time.monotonic() - start
            cells = sum(name.startswith("r") for name in half_cells(dataset))
            differs = "" if cells == len(all_cells) else f"{cells} half cells"
            trials.keep(Row(fault, None, ended_s, len(durable), len(lost), resumed_s, differs, said, wrong or wrong_end),
                        dataset)
            return True

    return trial


def traced(files, calls, injection):
    """Before a command: puts something in the place of the calls on these files, on all if there are none. A traced
    program cannot look for leaks."""
    paths = [word for file in files for word in ("-P", file)]
    return ["strace", "-f", "-qq", "--seccomp-bpf", "-E", "LSAN_OPTIONS=detect_leaks=0", "-o", "/dev/null", *paths,
            "-e", f"trace={calls}", "-e", f"inject={calls}:{injection}"]


def injected(fault, file, calls, when, before=None):
    """The calls on one file of the dataset fail."""

    def trial(trials, undo):
        dataset = trials.new_dataset()
        under = traced([dataset / file], calls, f"error=EIO:when={when}")
        with trials.bench() as bench:
            if before:
                before(trials, bench, dataset)
            return fails(trials, fault, trials.scan(bench, dataset, *under), dataset, "Input/output error", bench)

    return trial


def half_a_scan(trials, bench, dataset):
    scan = trials.scan(bench, dataset)
    scan.wait_for_cells(dataset, in_mid_scan)
    scan.kill()


def mountable(options_in):
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as undo:
        try:
            mount(undo, pathlib.Path(folder) / "disk", *options_in(pathlib.Path(folder)))
        except (subprocess.CalledProcessError, FileNotFoundError):
            return False
    return True


def may_mount():
    return os.environ.get("SURVIVE_MOUNTS") == "own" and mountable(lambda folder: ["-t", "tmpfs", "none"])


def may_loop():
    return mountable(lambda folder: ["-o", "loop", ext4_image(folder / "image")])


def may_inject():
    command = [*traced([], "fsync", "retval=0"), "true"]
    return shutil.which("strace") and subprocess.run(command, stderr=subprocess.DEVNULL).returncode == 0


mounts = [("small disks need root and mounts of their own", may_mount)]
loops = mounts + [("power cuts need ext4 on loop devices", may_loop)]
strace = [("calls that fail or do nothing need strace", may_inject)]

eio_on_flush = injected("EIO on fsync of a cell", cell_in_mid_scan, "fsync", "1+")
all_faults = [
    (mounts, full), (mounts, read_only), (loops, power_cut()), (loops, power_cut()), (loops, power_cut()),
    (loops, power_cut_by_hand()), (strace, injected("EIO on write of a cell", cell_in_mid_scan, "write", "1+")), (strace, eio_on_flush),
    (loops, full_beneath), (strace, injected("EIO on write of the journal", "journal.jsonl", "write", "5+")),
    (strace, injected("EIO on fsync of the journal", "journal.jsonl", "fsync", "5+")),
    (strace, injected("EIO on write of the manifest, closing", "luminaire.json.tmp", "write", "1+", half_a_scan)),
    (strace, injected("EIO on fsync of the manifest, closing", "luminaire.json.tmp", "fsync", "1+", half_a_scan))]
short_faults = [(mounts, full), (mounts, read_only), (strace, eio_on_flush)]

all_cells = [f"cells/r{row:02}_c{column:02}.1.exr.tmp" for row in range(3) for column in range(4)]
unflushed_faults = [(loops, power_cut()), (loops + strace, power_cut("cells never flushed", all_cells)),
                    (loops + strace, power_cut("journal never flushed", ["journal.jsonl"])),
                    (loops + strace, power_cut("nothing ever flushed", [])), (loops, power_cut_by_hand()),
                    (loops + strace, power_cut_by_hand("half cells never flushed", unflushed=True))]


def faults(which):
    """Each fault behind the rights that it needs, and how to find out about them."""
    return {"all": all_faults + unflushed_faults[1:], "short": short_faults, "unflushed": unflushed_faults,
            "none": []}[which]
