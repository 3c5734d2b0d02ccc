#!/usr/bin/env python3
"""Subjects for the tests of docs/batch, cut from the Colin 27 brain of Debian's package mricron-data:

    make_subjects.py make SUBJECTS COUNT       folders s01, s02, ... with labels, volume, names and trees
    make_subjects.py mirror SUBJECTS NAME      mirrors the labels of one subject and swaps left and right
    make_subjects.py count SUBJECTS            prints "subject,structure,voxels,ml" of every structure, sorted

The counts come from the files by nibabel alone, so they check the volumes table independently.
"""
import collections
import math
import pathlib
import sys

import nibabel
import numpy as np
import pydicom

TEMPLATES = pathlib.Path("/usr/share/mricron/templates")
BOX = ((46, 94), (92, 140), (62, 94))  # deep grey matter, nearly all of it on the left
MASKS_SUBJECT = 4     # a folder of masks, without volume
UNNAMED_SUBJECT = 5   # no names file
LABELS_ONLY = 6       # no volume
SCALED_SUBJECT = 7    # voxels of 0.5 x 0.5 x 1 mm instead of 1 mm
SCALES = (0.5, 0.5, 1)
DICOM_SUBJECT = 10    # the volume is a series of DICOM files
TREE = "Brain/Left hemisphere/*_L\nBrain/Right hemisphere/*_R\n"


def voxels_of(path):
    return np.asanyarray(nibabel.load(path).dataobj)


def cropped(name, shift, mirrored, scales):
    """The box, shifted by voxels along each axis, with its place. Mirrors the head before, not the box."""
    image = nibabel.load(TEMPLATES / f"{name}.nii.gz")
    data = np.asanyarray(image.dataobj)[::-1 if mirrored else 1]
    box = tuple(slice(first + step, last + step) for (first, last), step in zip(BOX, shift))
    affine = image.affine.copy()
    affine[:3, 3] += [axis.start for axis in box]
    affine[:3, :3] *= scales
    return nibabel.Nifti1Image(data[box], affine)


def names_of_labels():
    lines = (TEMPLATES / "aal.nii.txt").read_text().splitlines()
    return {int(line.split()[0]): line.split()[1] for line in lines if line.strip()}


def write_masks(folder, labels):
    """One mask for each structure of the label map."""
    folder.mkdir()
    names, data = names_of_labels(), np.asanyarray(labels.dataobj)
    for label in np.unique(data[data > 0]):
        nibabel.save(nibabel.Nifti1Image((data == label).astype(np.uint8), labels.affine),
                     folder / f"{names[label]}.nii.gz")


def write_series(folder, grey):
    """One MR slice a file, on the grid of the image. DICOM's x and y grow to the left and to the back."""
    folder.mkdir()
    data = np.asanyarray(grey.dataobj)
    right, front, up = grey.affine[:3, 3]
    for z in range(data.shape[2]):
        one = pydicom.Dataset()
        one.SOPClassUID, one.SOPInstanceUID = "1.2.840.10008.5.1.4.1.1.4", f"2.25.1.{z + 1}"
        one.Modality, one.SliceThickness, one.InstanceNumber = "MR", 1, z + 1
        one.StudyInstanceUID, one.SeriesInstanceUID, one.FrameOfReferenceUID = "2.25.3", "2.25.1", "2.25.4"
        one.ImagePositionPatient, one.ImageOrientationPatient = [-right, -front, up + z], [-1, 0, 0, 0, -1, 0]
        one.Columns, one.Rows, one.PixelSpacing = *data.shape[:2], [1, 1]
        one.SamplesPerPixel, one.PhotometricInterpretation, one.PixelRepresentation = 1, "MONOCHROME2", 0
        one.BitsAllocated, one.BitsStored, one.HighBit = 8, 8, 7
        one.PixelData = data[:, :, z].tobytes(order="F")
        one.file_meta = pydicom.dataset.FileMetaDataset()
        one.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
        one.is_little_endian, one.is_implicit_VR = True, False
        one.save_as(folder / f"{data.shape[2] - z:03}", write_like_original=False)


def make(folder, count):
    for number in range(1, count + 1):
        subject = folder / f"s{number:02}"
        subject.mkdir(parents=True)
        scales = SCALES if number == SCALED_SUBJECT else (1, 1, 1)
        place = ((number % 3, number % 4, number % 5), number % 2 == 0, scales)
        labels, grey = cropped("aal", *place), cropped("ch2", *place)
        if number == MASKS_SUBJECT:
            write_masks(subject / "masks", labels)
            continue
        nibabel.save(labels, subject / "labels.nii.gz")
        if number == DICOM_SUBJECT:
            write_series(subject / "dicom", grey)
        elif number != LABELS_ONLY:
            nibabel.save(grey, subject / "volume.nii.gz")
        if number != UNNAMED_SUBJECT:
            (subject / "names.txt").write_bytes((TEMPLATES / "aal.nii.txt").read_bytes())
            (subject / "tree.tree").write_text(TREE)


def mirror(subject):
    path = subject / "labels.nii.gz"
    image = nibabel.load(path)
    other = np.arange(256, dtype=np.uint8)  # AAL numbers pairs: 1 left, 2 right, to 107 and 108; then the vermis
    other[1:109] = other[1:109].reshape(-1, 2)[:, ::-1].ravel()
    nibabel.save(nibabel.Nifti1Image(other[np.array(image.dataobj)[::-1]], image.affine), path)


def count(folder):
    lines = []
    for subject in sorted(folder.iterdir()):
        found = collections.Counter()
        if (subject / "masks").is_dir():
            for mask in (subject / "masks").iterdir():
                found[mask.name.removesuffix(".nii.gz")] = np.count_nonzero(voxels_of(mask))
        else:
            names = names_of_labels() if (subject / "names.txt").exists() else {}
            for label, voxels in zip(*np.unique(voxels_of(subject / "labels.nii.gz"), return_counts=True)):
                if label > 0:
                    found[names.get(label, f"Label {label}")] = voxels
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
