"""What several shapes share is made once."""

from pathlib import Path

import numpy as np

from tests.pictures import write_exr
from tests.scene.formats.mitsuba_import import imported


def test_a_picture_under_a_rough_coat_is_changed_once(tmp_path: Path) -> None:
    """A room of 357 shapes of six plastics had 346 pictures."""
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "wood.exr", np.full((4, 4, 3), 0.4))
    bsdf = """
<bsdf type="twosided" id="wood"><bsdf type="roughplastic">
  <texture type="bitmap" name="diffuse_reflectance"><string name="filename" value="wood.exr"/></texture>
</bsdf></bsdf>
"""
    shape = '<shape type="rectangle"><ref id="wood"/></shape>'
    document, found = imported(tmp_path, bsdf + 3 * shape)
    assert [surface["kernel"] for surface in document["surfaces"]] == 3 * ["wood"]
    # The picture of the file, and the changed one.
    assert len(document["textures"]) == 2
    assert len(list((found.document.parent / "textures").iterdir())) == 2
