"""The picture of safety regions shows what the tables hold."""

import numpy as np

import narrows
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.viewer.region_pictures import regions_picture


def test_each_panel_shows_the_cells_of_its_region():
    options = RegionOptions(directions=24, levels=4, cell=0.1, castor_samples=2, pose_samples=5)
    regions = SafetyRegions.compute(narrows.load_vehicle("xeno"), options)
    motions = [(0.8, 0.0), (-0.4, 0.0)]
    figure = regions_picture(regions, motions)
    for axes, motion in zip(figure.axes, motions, strict=False):
        shown = np.ma.filled(axes.images[0].get_array(), np.nan)
        assert np.array_equal(np.isfinite(shown).T, regions.region(*motion))
        assert np.nanmax(shown) <= max(abs(motion[0]), 0.0)
