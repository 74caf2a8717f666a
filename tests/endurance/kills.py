"""Deaths of the program, at a random instant. Each returns whether it came before the scan had ended."""

import itertools
import os

from datasets import durable_cells


def alone(trials):
    """The bench lives on: its stage may be moving, its camera belongs to the dead program for its time-out."""
    at_s, dataset = trials.random.uniform(0, trials.whole_s), trials.new_dataset()
    with trials.bench() as bench:
        scan = trials.scan(bench, dataset)
        if scan.ends_within(at_s):
            return trials.ended_early(scan)
        scan.kill()
        trials.finish("kill -9 of the scan", dataset, durable_cells(dataset), bench, at_s=at_s)
    return True


def with_bench(trials):
    at_s, dataset = trials.random.uniform(0, trials.whole_s), trials.new_dataset()
    with trials.bench() as bench:
        scan = trials.scan(bench, dataset)
        if scan.ends_within(at_s):
            return trials.ended_early(scan)
        os.killpg(bench.process.pid, 9)
        scan.process.communicate()
    with trials.bench() as bench:
        trials.finish("kill -9 of scan and bench", dataset, durable_cells(dataset), bench, at_s=at_s)
    return True


def after(trials, fault, word, within_s):
    at_s, dataset = trials.random.uniform(0, within_s), trials.new_dataset()
    with trials.bench() as bench:
        scan = trials.retaking_scan(bench, dataset)
        if not scan.wait_for(word) or scan.ends_within(at_s):
            return trials.ended_early(scan)
        scan.kill()
        trials.finish(fault, dataset, durable_cells(dataset), bench, at_s=at_s, retaken=True)
    return True


def retaking(trials):
    return after(trials, "kill -9 while cells are taken again", "retaking", trials.retaking_s)


def closing(trials):
    return after(trials, "kill -9 while closing", "closing", trials.closing_s)


def kinds(count):
    return itertools.islice(itertools.cycle([alone, retaking, closing, with_bench, alone]), count)
