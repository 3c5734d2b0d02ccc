"""The commands of docs/gallery.md give the pictures that it shows."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).parents[2]
PROGRAMS = os.environ["SPLATLAS_PROGRAMS"]


class Gallery(unittest.TestCase):
    def test_commands_give_the_pictures_shown(self):
        page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
        commands = re.findall(r"^    (splatlas-player (?:.*\\\n)*.*)$", page, re.MULTILINE)
        self.assertEqual(len(commands), page.count("](gallery/"))
        with tempfile.TemporaryDirectory() as folder:
            made = pathlib.Path(folder, "docs", "gallery")
            made.mkdir(parents=True)
            pathlib.Path(folder, "out").mkdir()
            environment = os.environ | {"PATH": f"{PROGRAMS}:{os.environ['PATH']}"}
            build = f"splatlas-preprocess build -o '{folder}/out/colin27.atlas' @examples/colin27.args"
            for command, where in [(build, ROOT), *((command, folder) for command in commands)]:
                done = subprocess.run(["bash", "-c", command], cwd=where, env=environment, stderr=subprocess.PIPE)
                self.assertEqual(done.returncode, 0, done.stderr)
            for picture in sorted(made.iterdir()):
                shown = ROOT / "docs" / "gallery" / picture.name
                self.assertEqual(picture.read_bytes(), shown.read_bytes(), f"{picture.name} differs from {shown}")


if __name__ == "__main__":
    unittest.main()
