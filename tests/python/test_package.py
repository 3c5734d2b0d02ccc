"""The package splatlas: arrays against nibabel and closed forms, pictures against splatlas-player."""
import concurrent.futures
import dataclasses
import functools
import inspect
import itertools
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import timeit
import unittest
import warnings

import nibabel
import numpy as np

import splatlas

PROGRAMS = pathlib.Path(splatlas.__file__).parents[2] / "bin"
SHAPE = (14, 11, 9)
ROTATED = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1.0]])
GRIDS = {
    "oblique": ROTATED * (1.5, 1, 2),
    "mirrored": np.diag((-1.0, 2, 1)),
    "permuted": np.eye(3)[:, [2, 0, 1]] * (1, -1, 3),
    "sheared": np.array([[1, 0.2, 0], [0, 1, 0.1], [0, 0, 1.0]]),
}


def affine_of(matrix):
    return nibabel.affines.from_matvec(matrix, (-7, 5, 11))


def boxes(dtype=np.uint8):
    """Label 3: 5 x 4 x 3 voxels; label 7: 2 x 2 x 2."""
    labels = np.zeros(SHAPE, dtype)
    labels[2:7, 1:5, 3:6] = 3
    labels[9:11, 6:8, 2:4] = 7
    return labels


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        warnings.simplefilter("ignore", splatlas.Warning)

    def build(self, **sources):
        path = self.folder / f"{len(list(self.folder.iterdir()))}.atlas"
        splatlas.build(path, **sources)
        return splatlas.open(path)

    def boxes(self):
        return self.build(labels=boxes(), affine=affine_of(np.eye(3)), names={3: "Liver", 7: "Screw"},
                          volume=np.arange(np.prod(SHAPE), dtype=np.int16).reshape(SHAPE))

    def test_segments_of_the_guide_are_those_of_others(self):
        guide = (pathlib.Path(__file__).parents[2] / "docs/guide.md").read_text()
        rules = dict(re.findall(r"^    --segment (\w+)=(\S+)$", guide, re.MULTILINE))
        templates, data = pathlib.Path("/usr/share/mricron/templates"), os.environ.get("SPLATLAS_TEST_DATA")
        head = ["--volume", templates / "ch2.nii.gz", "--segment", f"BET=mask:{templates / 'ch2bet.nii.gz'}"]
        cases = [("Brain", 0.96, head, ["BET"])]
        if data:
            chest = ["--labels", f"{data}/slicerio/Segmentation.seg.nrrd", "--volume", f"{data}/slicerio/CTChest4.nrrd"]
            spine = [f"{part} vertebral column" for part in ("cervical", "thoracic", "lumbar")]
            cases += [("Lungs", 0.995, chest, ["left lung", "right lung"]), ("Bone", 0.867, chest, ["ribs", *spine])]
        for name, least, sources, structures in cases:
            path = self.folder / f"{name}.atlas"
            subprocess.run([PROGRAMS / "splatlas-preprocess", "build", "-o", path, *sources,
                            "--segment", f"{name}={rules[name]}:overlap"], check=True, capture_output=True)
            atlas = splatlas.open(path)
            ours, others = atlas.mask(name) > 0, np.any([atlas.mask(one) > 0 for one in structures], axis=0)
            self.assertGreater(2 * (ours & others).sum() / (ours.sum() + others.sum()), least, name)  # Dice

    def test_arrays_equal_those_of_nibabel_in_every_grid(self):
        values = np.arange(np.prod(SHAPE), dtype=np.float32).reshape(SHAPE)
        for name, matrix in GRIDS.items():
            with self.subTest(grid=name):
                images = [nibabel.Nifti1Image(array, affine_of(matrix)) for array in (boxes(), values)]
                atlas = self.build(labels=images[0], volume=images[1])
                np.testing.assert_array_equal(atlas.labels(), boxes())
                np.testing.assert_array_equal(atlas.volume(), values)
                np.testing.assert_allclose(atlas.affine, affine_of(matrix), atol=1e-6)
                if name != "sheared":  # which NIfTI's quaternions do not hold
                    exported = self.folder / f"{name}.nii.gz"
                    subprocess.run([PROGRAMS / "splatlas-preprocess", "export", atlas.path, "--labels", exported],
                                   check=True, capture_output=True)
                    image = nibabel.load(exported)
                    np.testing.assert_array_equal(np.asanyarray(image.dataobj), atlas.labels())
                    np.testing.assert_allclose(image.affine, atlas.affine, atol=1e-5)
                vertices, triangles, normals = atlas.surface("#3")
                corners = vertices[triangles]
                volume = np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
                self.assertGreater(volume, 0)  # counter-clockwise from outside
                indices = nibabel.affines.apply_affine(np.linalg.inv(atlas.affine), vertices)
                np.testing.assert_allclose(indices.mean(0), (4, 2.5, 4), atol=0.05)
                np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-3)

    def test_arrays_of_all_types_build_what_files_build(self):
        for dtype in (bool, np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64):
            with self.subTest(dtype=dtype):
                atlas = self.build(labels=boxes(dtype), affine=np.eye(4))
                np.testing.assert_array_equal(atlas.labels(), boxes(dtype))
        strided = np.zeros((28, 11, 18), np.uint8)[::2, :, ::-2]
        strided[...] = boxes()
        names = self.folder / "names.csv"
        names.write_text("label,name,color\n3,Liver,#aa3311\n7,Screw,#cccccc\n")
        rows = [{"label": 3, "name": "Liver", "color": "#aa3311"}, {"label": 7, "name": "Screw", "color": "#cccccc"}]
        image = self.folder / "labels.nii.gz"
        nibabel.save(nibabel.Nifti1Image(boxes(), np.eye(4)), image)
        of_files = self.build(labels=image, names=names)
        for made in (self.build(labels=strided, affine=np.eye(4), names=rows),
                     self.build(labels=nibabel.load(image), names=names)):
            np.testing.assert_array_equal(made.labels(), of_files.labels())
            self.assertEqual(made.structures, of_files.structures)
        self.assertEqual([(one.name, one.color, one.label, one.voxels) for one in of_files.structures],
                         [("Liver", "#aa3311", 3, 60), ("Screw", "#cccccc", 7, 8)])

    def test_groups_trees_and_meshes(self):
        corners = np.array([(4, 4, 4), (8, 4, 4), (4, 8, 4), (4, 4, 8.5)])
        faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
        atlas = self.build(labels={"left": boxes(), "right": boxes()[::-1]}, affine=np.eye(4),
                           meshes={"Needle": (corners, faces)})
        self.assertEqual(atlas.mask("left/*").sum(), 68)
        self.assertEqual({one.parents for one in atlas.find("*/Label 3")}, {("left",), ("right",)})
        vertices, triangles, _ = atlas.surface("Needle")
        self.assertEqual(triangles.shape, (4, 3))
        np.testing.assert_allclose(np.sort(vertices[:, 2]), (4,) * 9 + (8.5,) * 3, atol=1e-3)  # hard edges
        tree = self.build(labels=boxes(), affine=np.eye(4), names={3: "Liver", 7: "Screw"}, tree=["Body/Liver"])
        self.assertEqual(tree.find("Liver")[0].parents, ("Body",))
        np.testing.assert_array_equal(tree.labels("Body") == 3, tree.mask("Liver"))
        self.assertEqual(tree.labels("Body").max(), 3)

    def test_pictures_equal_those_of_the_player(self):
        atlas = self.boxes()
        for words, options in (
                ([], {}),
                (["--select", "Liver:surface", "--view", "left", "--quality", "draft", "--size", "320x200"],
                 {"select": "Liver:surface", "view": "left", "quality": "draft", "size": (320, 200)}),
                (["--cut", "superior=14", "--azimuth", "30", "--zoom", "1.5", "--background", "transparent"],
                 {"cuts": {"superior": 14}, "azimuth": 30, "zoom": 1.5, "background": None})):
            path = self.folder / "picture.png"
            size = [] if "--size" in words else ["--size", "800x600"]
            subprocess.run([PROGRAMS / "splatlas-player", "render", atlas.path, "-o", path, *size, *words],
                           check=True, capture_output=True)
            self.assertEqual(atlas.render(**options)._repr_png_(), path.read_bytes(), words)

    def test_pictures_have_ids_depths_and_picks(self):
        atlas = self.boxes()
        picture = atlas.render("Liver:surface", size=(200, 100), ids=True, depth=True, background=None)
        self.assertEqual((picture.array.shape, picture.array.dtype), ((100, 200, 4), np.uint8))
        self.assertEqual((picture.linear.shape, picture.linear.dtype), ((100, 200, 4), np.float32))
        self.assertEqual(set(np.unique(picture.ids)), {0, 1 + atlas.find("Liver")[0].index})
        np.testing.assert_array_equal(np.isfinite(picture.depth), picture.ids > 0)
        structure, point = picture.pick(100, 50)
        self.assertEqual(structure.name, "Liver")
        np.testing.assert_allclose(point[[0, 2]], (4 - 7, 4 + 11), atol=0.6)  # the middle of the box
        self.assertIsNone(picture.pick(1, 1))
        turned = atlas.render("Liver:surface", size=(200, 100), camera=picture.camera, azimuth=90)
        self.assertEqual(turned.camera, picture.camera | {"azimuth": 90})
        del picture, turned
        kept = atlas.render("Liver", size=(8, 8)).linear  # outlives its picture
        self.assertFalse(np.array_equal(kept, atlas.render("Screw", size=(8, 8)).linear))

    def test_faults_are_exceptions(self):
        atlas = self.boxes()
        draw, picture = atlas.render, atlas.render("Liver", size=(8, 8))
        draw("Screw", size=(8, 8))
        for kind, subject, fault in (
                ("not found", "selection", lambda: draw("Lever")), ("not found", "Lever", lambda: atlas.mask("Lever")),
                ("usage", "size", lambda: draw(size=(0, 9))), ("usage", "quality", lambda: draw(quality="best")),
                ("usage", "background", lambda: draw(background="red!")), ("usage", "", lambda: picture.pick(1, 1)),
                ("usage", "cuts", lambda: draw(cuts={"up": 3})), ("usage", "a.bmp", lambda: picture.save("a.bmp")),
                ("failed", f"{self.folder}/\\xff", lambda: splatlas.open(os.fsencode(self.folder) + b"/\xff")),
                ("invalid atlas", __file__, lambda: splatlas.open(__file__)),
                ("failed", f"{self.folder}/none.nrrd", lambda: self.build(labels=self.folder / "none.nrrd"))):
            with self.assertRaises(splatlas.Error) as raised:
                fault()
            self.assertEqual((raised.exception.kind, raised.exception.subject), (kind, subject), raised.exception)
        self.assertEqual(splatlas.Error.__module__, "splatlas")  # in tracebacks
        for fault in (lambda: draw(view="up"), lambda: draw(scene="none"), lambda: draw(zoom=0), lambda: draw(size=8),
                      lambda: draw(size="8x8"), lambda: picture.save("a\0.png"), lambda: draw(center=(np.nan, 0, 0)),
                      lambda: draw(azimuth="x"), lambda: draw(camera={"azimut": 3}),
                      lambda: draw(camera=picture.camera, zoom=2), lambda: self.build(labels="a", affine=np.eye(4)),
                      lambda: self.build(labels=boxes()), lambda: self.build(labels=picture.save, affine=np.eye(4)),
                      lambda: self.build(labels={"a=b": boxes()}, affine=np.eye(4)),
                      lambda: self.build(labels=boxes()[0], affine=np.eye(4)),
                      lambda: self.build(labels=boxes(), affine=np.eye(3)),
                      lambda: self.build(labels=boxes().astype(complex), affine=np.eye(4)),
                      lambda: self.build(labels=np.full(SHAPE, 2**40), affine=np.eye(4)),
                      lambda: self.build(meshes={"a": (np.eye(3), np.array([(0, 1, 3)]))})):
            self.assertRaises((TypeError, ValueError), fault)
        atlas.close()
        for closed in (atlas.labels, atlas.volume, atlas.render, atlas.renderer, atlas.show):
            self.assertRaisesRegex(ValueError, "closed", closed)

    def test_arguments_of_wrong_types_are_refused_by_name(self):
        atlas = self.boxes()
        picture = atlas.render(size=(8, 8))
        needed = {"path": "a.png", "output": "a", "x": 1, "y": 1, "name": "Liver", "names": "Liver"}
        for call in (atlas.render, atlas.find, atlas.labels, atlas.mask, atlas.surface, atlas.show, picture.pick,
                     picture.save, splatlas.open, splatlas.build):
            parameters = inspect.signature(call).parameters
            self.assertEqual([name for name in parameters if not re.search(rf"\b{name}\b", call.__doc__)], [], call)
            given = {name: needed[name] for name in parameters if parameters[name].default is inspect.Parameter.empty}
            for name, value in itertools.product(parameters, (3j, object(), [object()], "\ud800\n", np.zeros((9, 9)))):
                if (name, type(value)) in (("labels", str), ("volume", str), ("names", str), ("tree", str)):
                    continue  # paths
                with self.assertRaisesRegex((TypeError, ValueError), rf"\A{name}: .*must .*\Z", msg=value):
                    call(**given | {name: value})
        self.assertFalse([name for name in vars(atlas) if name[0] != "_" and name not in splatlas.Atlas.__doc__])
        for camera in ({"zoom": "a"}, {"center": (1, 2)}, {"projection": 5}, {"azimuth": np.nan}):
            self.assertRaisesRegex((TypeError, ValueError), r"\Acamera: .*: must be .*\Z", atlas.render, camera=camera)
        other = dataclasses.replace(atlas.structures[0], index=10**6)
        for fault, call in (("names: .* another atlas", lambda: atlas.mask(other)),
                            ("focus: .* another atlas", lambda: atlas.render(focus=other)),
                            (r"max_work: -1.0: must be .*", lambda: splatlas.open(atlas.path, max_work=-1)),
                            (r"Renderer.render\(\) got an .* 'zom'", lambda: atlas.render(zom=2))):
            self.assertRaisesRegex((TypeError, ValueError), rf"\A{fault}\Z", call)

    def test_numbers_of_numpy_structures_and_renderers_are_taken(self):
        atlas = self.boxes()
        liver, = atlas.find("Liver")
        picture = atlas.render("Liver", size=np.array((8, 8)), azimuth=np.float32(30), ids=np.bool_(True),
                               cuts={"left": np.float64(50)}, focus=liver)
        self.assertEqual(picture.camera["azimuth"], 30)
        np.testing.assert_array_equal(atlas.mask([liver, "Screw"]), boxes() > 0)
        splatlas.build(atlas.path, labels=boxes(), affine=np.eye(4), names={3: "Other", 7: "Names"})
        other = atlas.renderer().render("Liver", size=(8, 8), azimuth=30)  # of the open file, not of the new one
        self.assertEqual(other.pick(4, 4)[0], liver)
        self.assertIsNotNone(picture.pick(4, 4))
        image = nibabel.Nifti1Image(boxes()[..., None], np.eye(4))
        image.header.set_xyzt_units("meter")
        np.testing.assert_allclose(self.build(labels=image).affine, np.diag((1000, 1000, 1000, 1)))

    def test_empty_pictures_are_warned_of_each_time(self):
        atlas = self.boxes()
        for options in ({"select": "Liver - Liver"}, {"select": "Liver - Liver"}, {"cuts": {"left": -500}}):
            with self.assertWarnsRegex(splatlas.Warning, "shows nothing") as caught:
                atlas.render(size=(8, 8), **options)
            self.assertEqual(caught.filename, __file__)

    @unittest.skipUnless((PROGRAMS.parents[1] / "web/splatlas.wasm").exists(), "built without the module for pages")
    def test_notes_are_warnings_and_the_page_is_shown(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            atlas = self.build(labels=boxes(), affine=np.eye(4), names={3: "Liver", 7: "Screw", 9: "Ghost"})
        self.assertEqual([one.category for one in caught], [splatlas.Warning])
        self.assertEqual(caught[0].filename, __file__)
        page = atlas.show("Liver", height=300)
        self.assertEqual((page._repr_html_()[:15], "Liver" in page.html, repr(page)),
                         ("<iframe srcdoc=", True, "Page(height=300)"))

    def test_ctrl_c_ends_a_picture(self):
        atlas, files = self.boxes(), list(self.folder.iterdir())
        large = atlas.render("Liver", size=(4000, 4000), quality="draft")
        for work in (lambda: atlas.render("*:volume(opacity=0.1)", size=(9000, 9000), quality="high", azimuth=20),
                     *(functools.partial(large.save, self.folder / f"a.{ending}") for ending in ("png", "tif", "exr"))):
            threading.Timer(0.05, signal.raise_signal, [signal.SIGINT]).start()
            self.assertRaises(KeyboardInterrupt, work)
        self.assertEqual(list(self.folder.iterdir()), files)
        atlas.render("Liver", size=(8, 8))

    def test_ctrl_c_ends_arrays(self):
        large = self.build(labels=np.pad(boxes(), 195), affine=np.eye(4))
        for work in (large.labels, functools.partial(large.mask, "*")):
            def seconds(wait):
                start, timer = time.monotonic(), threading.Timer(wait, signal.raise_signal, [signal.SIGINT])
                with self.assertRaises(KeyboardInterrupt):
                    timer.start()
                    work()
                    timer.join()
                return time.monotonic() - start
            whole = min(timeit.repeat(work, number=1, repeat=3))
            self.assertLess(min(seconds(whole / 8) for _ in range(5)), 0.85 * whole)  # it was the whole

    def test_threads_that_draw_end_with_python(self):
        script = "import splatlas, threading, time\natlas = splatlas.open({!r})\ndef draw():\n while True: {}\n" \
                 "for _ in range(2): threading.Thread(target=draw, daemon=True).start()\ntime.sleep(0.3)"
        for work in ("atlas.render(size=(64, 64)).array", "splatlas.open(atlas.path).mask('*')"):
            done = subprocess.run([sys.executable, "-c", script.format(self.boxes().path, work)], capture_output=True)
            self.assertEqual((done.returncode, done.stderr), (0, b""), work)

    def test_threads_share_atlases_and_nothing_leaks(self):
        atlases = [self.boxes(), self.boxes()]
        expected = atlases[0].render("Liver", size=(64, 64)).array
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            made = pool.map(lambda n: atlases[n % 2].render("Liver", size=(64, 64)).array, range(200))
            self.assertTrue(all(np.array_equal(array, expected) for array in made))
        def use(times):
            for n in range(times):
                picture = atlases[0].render("Liver", size=(32, 32), azimuth=n % 7)
                picture.array, picture.linear, picture.pick(1, 1), atlases[0].find("Screw"), atlases[0].labels()
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        self.assertLess(use(2000) - use(200), 8 << 10)  # KiB; leaked pictures were 28 MiB


if __name__ == "__main__":
    unittest.main()
