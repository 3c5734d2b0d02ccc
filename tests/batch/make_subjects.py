#!/usr/bin/env python3
"""Subjects for the tests of docs/batch, cut from the Colin 27 brain of Debian's package mricron-data:

    make_subjects.py make SUBJECTS COUNT       folders s01, s02, ... with labels, volume, names and trees
    make_subjects.py mirror SUBJECTS NAME      mirrors the labels of one subject and swaps left and right
    make_subjects.py count SUBJECTS            prints "subject,structure,voxels,ml" of every structure, sorted

The counts come from the bytes of the files alone, so they check the volumes table independently.
NIfTI files are edited with struct and gzip: x is the fastest axis, and grows to the right.
"""
import collections
import gzip
import math
import pathlib
import struct
import sys

TEMPLATES = pathlib.Path("/usr/share/mricron/templates")
SIZE = (181, 217, 181)
HEADER_BYTES = 352
BOX = (range(46, 94), range(92, 140), range(62, 94))  # deep grey matter, nearly all of it on the left
MASKS_SUBJECT = 4     # a folder of masks, without volume
UNNAMED_SUBJECT = 5   # no names file
LABELS_ONLY = 6       # no volume
SCALED_SUBJECT = 7    # voxels of 0.5 x 0.5 x 1 mm instead of 1 mm
SCALES = (0.5, 0.5, 1)
DICOM_SUBJECT = 10    # the volume is a series of DICOM files
TREE = "Brain/Left hemisphere/*_L\nBrain/Right hemisphere/*_R\n"


def read_template(name):
    data = gzip.decompress((TEMPLATES / f"{name}.nii.gz").read_bytes())
    if struct.unpack_from("<8h", data, 40)[1:4] != SIZE or struct.unpack_from("<h", data, 70)[0] != 2:
        sys.exit(f"{name}: not the expected template of one byte a voxel")
    return bytearray(data)


def rows(data, size):
    """The voxels as rows along x, in the order of the file."""
    return [data[begin:begin + size[0]] for begin in range(HEADER_BYTES, len(data), size[0])]


def cropped(data, shift, mirrored):
    """The box, shifted by voxels along each axis; the origin moves with it. Mirrors the head before, not the box."""
    box = [range(axis.start + step, axis.stop + step) for axis, step in zip(BOX, shift)]
    header = bytearray(data[:HEADER_BYTES])
    struct.pack_into("<3h", header, 42, *(len(axis) for axis in box))
    for axis, offset in enumerate((292, 308, 324)):  # last column of the sform
        origin, = struct.unpack_from("<f", data, offset)
        struct.pack_into("<f", header, offset, origin + box[axis].start)
    voxels = bytearray()
    for z in box[2]:
        for y in box[1]:
            begin = HEADER_BYTES + SIZE[0] * (y + SIZE[1] * z)
            row = data[begin:begin + SIZE[0]]
            voxels += (row[::-1] if mirrored else row)[box[0].start:box[0].stop]
    return bytes(header + voxels)


def scaled(data):
    """The same voxels with other spacings."""
    header = bytearray(data[:HEADER_BYTES])
    for axis, (spacing, row) in enumerate(zip(SCALES, (280, 296, 312))):
        struct.pack_into("<f", header, 80 + 4 * axis, spacing)
        struct.pack_into("<f", header, row + 4 * axis, spacing)
    return bytes(header) + data[HEADER_BYTES:]


def write(path, data):
    path.write_bytes(gzip.compress(data, 6, mtime=0))


def names_of_labels():
    lines = (TEMPLATES / "aal.nii.txt").read_text().splitlines()
    return {int(line.split()[0]): line.split()[1] for line in lines if line.strip()}


def write_masks(folder, labels):
    """One mask for each structure of the label map."""
    folder.mkdir()
    names = names_of_labels()
    for label in sorted(set(labels[HEADER_BYTES:]) - {0}):
        table = bytes(int(value == label) for value in range(256))
        write(folder / f"{names[label]}.nii.gz", labels[:HEADER_BYTES] + labels[HEADER_BYTES:].translate(table))


def element(group, number, kind, value):
    """A data element of DICOM, explicit VR, little endian."""
    if isinstance(value, str):
        value = value.encode()
    value += (b"\0" if kind in ("UI", "OB") else b" ") * (len(value) % 2)
    length = struct.pack("<2xI", len(value)) if kind in ("OB", "OW") else struct.pack("<H", len(value))
    return struct.pack("<2H", group, number) + kind.encode() + length + value


def write_series(folder, grey):
    """One MR slice a file, on the grid of the NIfTI file. DICOM's x and y grow to the left and to the back."""
    folder.mkdir()
    width, height, depth = struct.unpack_from("<3h", grey, 42)
    left, back, up = (struct.unpack_from("<f", grey, offset)[0] for offset in (292, 308, 324))
    mr_image, series = "1.2.840.10008.5.1.4.1.1.4", "2.25.1"
    for z in range(depth):
        begin = HEADER_BYTES + z * width * height
        pixels = grey[begin:begin + width * height]
        meta = b"".join([
            element(2, 1, "OB", b"\0\1"), element(2, 2, "UI", mr_image), element(2, 3, "UI", f"{series}.{z + 1}"),
            element(2, 0x10, "UI", "1.2.840.10008.1.2.1"), element(2, 0x12, "UI", "2.25.2")])
        data = b"".join([
            element(8, 0x16, "UI", mr_image), element(8, 0x18, "UI", f"{series}.{z + 1}"), element(8, 0x60, "CS", "MR"),
            element(0x18, 0x50, "DS", "1"),
            element(0x20, 0xd, "UI", "2.25.3"), element(0x20, 0xe, "UI", series), element(0x20, 0x13, "IS", str(z + 1)),
            element(0x20, 0x32, "DS", f"{-left}\\{-back}\\{up + z}"), element(0x20, 0x37, "DS", "-1\\0\\0\\0\\-1\\0"),
            element(0x20, 0x52, "UI", "2.25.4"),
            element(0x28, 2, "US", struct.pack("<H", 1)), element(0x28, 4, "CS", "MONOCHROME2"),
            element(0x28, 0x10, "US", struct.pack("<H", height)), element(0x28, 0x11, "US", struct.pack("<H", width)),
            element(0x28, 0x30, "DS", "1\\1"), element(0x28, 0x100, "US", struct.pack("<H", 8)),
            element(0x28, 0x101, "US", struct.pack("<H", 8)), element(0x28, 0x102, "US", struct.pack("<H", 7)),
            element(0x28, 0x103, "US", struct.pack("<H", 0)), element(0x7fe0, 0x10, "OB", pixels)])
        length = element(2, 0, "UL", struct.pack("<I", len(meta)))
        (folder / f"{depth - z:03}").write_bytes(bytes(128) + b"DICM" + length + meta + data)


def make(folder, count):
    labels, volume = read_template("aal"), read_template("ch2")
    for number in range(1, count + 1):
        subject = folder / f"s{number:02}"
        subject.mkdir(parents=True)
        shift, mirrored = (number % 3, number % 4, number % 5), number % 2 == 0
        cut, grey = cropped(labels, shift, mirrored), cropped(volume, shift, mirrored)
        if number == SCALED_SUBJECT:
            cut, grey = scaled(cut), scaled(grey)
        if number == MASKS_SUBJECT:
            write_masks(subject / "masks", cut)
            continue
        write(subject / "labels.nii.gz", cut)
        if number == DICOM_SUBJECT:
            write_series(subject / "dicom", grey)
        elif number != LABELS_ONLY:
            write(subject / "volume.nii.gz", grey)
        if number != UNNAMED_SUBJECT:
            (subject / "names.txt").write_bytes((TEMPLATES / "aal.nii.txt").read_bytes())
            (subject / "tree.tree").write_text(TREE)


def mirror(subject):
    path = subject / "labels.nii.gz"
    data = gzip.decompress(path.read_bytes())
    size = struct.unpack_from("<3h", data, 42)
    # AAL numbers pairs: 1 left, 2 right, up to 107 and 108; then the vermis.
    swap = bytes(value + 1 if value % 2 else value - 1 for value in range(1, 109))
    table = bytes([0]) + swap + bytes(range(109, 256))
    write(path, data[:HEADER_BYTES] + b"".join(row[::-1].translate(table) for row in rows(data, size)))


def count(folder):
    lines = []
    for subject in sorted(folder.iterdir()):
        found = collections.Counter()
        if (subject / "masks").is_dir():
            for mask in (subject / "masks").iterdir():
                found[mask.name.removesuffix(".nii.gz")] = gzip.decompress(mask.read_bytes())[HEADER_BYTES:].count(1)
        else:
            names = names_of_labels() if (subject / "names.txt").exists() else {}
            voxels = gzip.decompress((subject / "labels.nii.gz").read_bytes())[HEADER_BYTES:]
            found.update({names.get(label, f"Label {label}"): voxels.count(label) for label in set(voxels) - {0}})
        if (subject / "tree.tree").exists():
            left = sum(voxels for name, voxels in found.items() if name.endswith("_L"))
            right = sum(voxels for name, voxels in found.items() if name.endswith("_R"))
            for name, total in (("Left hemisphere", left), ("Right hemisphere", right), ("Brain", left + right)):
                if total:
                    found[name] = total
        ml = math.prod(SCALES if subject.name == f"s{SCALED_SUBJECT:02}" else (1, 1, 1)) / 1000
        lines += [f"{subject.name},{name},{voxels},{voxels * ml:.9g}" for name, voxels in found.items()]
    print("\n".join(sorted(lines)))


if __name__ == "__main__":
    what, root = sys.argv[1], pathlib.Path(sys.argv[2])
    if what == "make":
        make(root, int(sys.argv[3]))
    elif what == "mirror":
        mirror(root / sys.argv[3])
    elif what == "count":
        count(root)
    else:
        sys.exit(__doc__)
