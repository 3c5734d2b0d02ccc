"""The notebook of examples/ runs on the demo's atlas, and shows what it says."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import unittest.mock

import nbclient
import nbformat

ROOT = pathlib.Path(__file__).parents[2]


class Notebook(unittest.TestCase):
    def test_shows_pictures_rows_and_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/brain.atlas"
            subprocess.run([f"{os.environ['SPLATLAS_PROGRAMS']}/splatlas-preprocess", "build", "-o", path,
                            "@examples/colin27.args"], cwd=ROOT, check=True, capture_output=True)
            notebook = nbformat.read(ROOT / "examples" / "atlas.ipynb", as_version=4)
            with unittest.mock.patch.dict(os.environ, SPLATLAS_ATLAS=path):
                nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": folder}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        data = [output.data for output in outputs if "data" in output]
        self.assertEqual(len({one["image/png"] for one in data if "image/png" in one}), 5)
        self.assertEqual([one["text/html"][:15] for one in data if "text/html" in one], ["<iframe srcdoc="])
        texts = [output.text for output in outputs if output.get("name") == "stdout"]
        self.assertEqual(len(re.findall(r"^\S.{23} +\d+ +\d+\.\d ml$", texts[0], re.MULTILINE)), 8)
        self.assertEqual([output.text for output in outputs if output.get("name") == "stderr"], [])


if __name__ == "__main__":
    unittest.main()
