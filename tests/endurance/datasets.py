"""What a dataset on disk holds (luminaire/dataset.h), read without Lumifield's code, and whether two are identical."""

import hashlib
import json
import subprocess


def durable_cells(dataset, written_lines=None):
    """The entry of each cell: the manifest's, then the journal's whole lines, the last one counting. Of a journal that
    is being written, give how many lines are known to be flushed."""
    manifest = parsed(contents(dataset / "luminaire.json"))
    if not manifest:
        return {}
    entries = manifest["cells"] + journal(dataset)[:written_lines]
    return {(entry["row"], entry["column"]): entry for entry in entries}


def journal(dataset):
    lines = contents(dataset / "journal.jsonl").split(b"\n")[:-1]
    return [entry for line in lines if (entry := parsed(line))]


def half_cells(dataset):
    """The checksum of each file in `halves` that is what it says."""
    files = {file.name: contents(file).partition(b"\n") for file in (dataset / "halves").glob("*.raw")}
    return {name: sha256 for name, (sha256, _, rest) in files.items()
            if hashlib.sha256(rest).hexdigest().encode() == sha256}


def contents(file):
    try:
        return file.read_bytes()
    except FileNotFoundError:
        return b""


def parsed(text):
    """Nothing where it is damaged, as a file that was not flushed may be."""
    try:
        return json.loads(text)
    except ValueError:
        return None


def lost_cells(before, dataset):
    """Cells that were durable and are gone, others, or damaged."""
    after = durable_cells(dataset)

    def is_there(cell, entry):
        sha256 = hashlib.sha256(contents(dataset / entry["file"])).hexdigest()
        return entry["sha256"] == after.get(cell, {}).get("sha256") == sha256

    return {cell for cell, entry in before.items() if not is_there(cell, entry)}


def written_ns(durable, dataset):
    """When the file of each cell that is there was written."""
    files = {cell: dataset / entry["file"] for cell, entry in durable.items()}
    return {cell: file.stat().st_mtime_ns for cell, file in files.items() if file.exists()}


def leftovers(dataset):
    """Files that belong to no cell, temporary ones, folders that were not finished."""
    listed = {"luminaire.json"} | {entry["file"] for entry in durable_cells(dataset).values()}
    inside = [str(file.relative_to(dataset)) for file in dataset.rglob("*") if not file.is_dir()]
    return [name for name in inside if name not in listed] + [
        each.name for each in dataset.parent.glob(dataset.name + "?*")]


def difference(dataset, reference, same_pixels, retaken):
    """Empty when identical: the cells' pixels, and the manifest without provenance and times. A cell that was taken
    again has another generation, and so another file."""
    manifests = [json.loads((each / "luminaire.json").read_text()) for each in (dataset, reference)]
    for manifest in manifests:
        del manifest["provenance"]
        for cell in manifest["cells"]:
            for name in ("generation", "file", "sha256") if retaken else ():
                del cell[name]
    if manifests[0] != manifests[1]:
        return "the manifests differ: " + where_different(*manifests)
    if extra := leftovers(dataset):
        return "left over: " + ", ".join(extra)
    pixels = subprocess.run([same_pixels, dataset, reference], capture_output=True, text=True)
    return (pixels.stdout + pixels.stderr).strip() if pixels.returncode else ""


def where_different(a, b, place=""):
    """The first of the places in which two JSON values differ, and both values there."""
    inner = []
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        inner = [(a[key], b[key], f"{place}.{key}") for key in a]
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        inner = [(*pair, f"{place}[{k}]") for k, pair in enumerate(zip(a, b))]
    return next((where_different(*each) for each in inner if each[0] != each[1]), f"{place}: {a} and {b}")
