"""Writes openexr.exr beside this file, by the reference implementation (pip install OpenEXR==3.5.3)."""
import pathlib
import numpy as np
import OpenEXR

y, x = np.mgrid[0:9, 0:13]
z = ((x * x * 7 + y * 13 + x * y * 3) % 256 / np.float32(256)).astype(np.float32)
z[0, 0], z[8, 12] = np.inf, 1e-45
a = ((x * 5 + y * 11) % 64 / 64 - 0.5).astype(np.float16)
a[0, 1], a[0, 2] = -np.inf, 6e-8
index = (x * 40503 + y * 2654435761).astype(np.uint32)
index[0, 0] = 0xFFFFFFFF
tiles = OpenEXR.TileDescription()
tiles.xSize, tiles.ySize = 8, 4
lines = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.PIZ_COMPRESSION, "splatref": "h\u00e9llo"}
tiled = {"type": OpenEXR.tiledimage, "compression": OpenEXR.ZIP_COMPRESSION, "tiles": tiles}
OpenEXR.File([
    OpenEXR.Part(lines, {"Z": z, "A": a, "id": index}, name="lines"),
    OpenEXR.Part(tiled, {"Z": z, "id": index}, name="tiles"),
]).write(str(pathlib.Path(__file__).with_name("openexr.exr")))
