"""Prints the references of src/compare/metrics/flip (pip install flip-evaluator==1.7 numpy).

flip-evaluator is the implementation of the authors of FLIP, in f32.
"""
import flip_evaluator
import numpy as np


def ramp(x, y):
    return (x * 4 + y * 2) % 256 / 256


def pattern(x, y):
    return (x * x * 7 + y * 13 + x * y * 3) % 256 / 256


def disc(x, y):
    return np.where((x - 9) ** 2 + (y - 7) ** 2 < 40, 0.75, 0.0625)


def gray(values):
    return [values, values, values]


def pair(name, x, y):
    if name == "shifted":
        return [ramp(x, y), pattern(x, y), disc(x, y)], [
            ramp(x + 1, y), pattern(x + 1, y), disc(x + 1, y)]
    if name == "edge":
        return gray(disc(x, y)), gray(disc(x, y + 3))
    if name == "colour":
        return [ramp(x, y), disc(x, y), 0.5 + 0 * x], [disc(x, y), 0.25 + 0 * x, ramp(x, y)]
    if name == "faint":
        return gray(0.5 + 0 * x), gray(0.5 + pattern(x, y) / 16)
    if name == "farthest":
        return [0 * x, 1 + 0 * x, 0 * x], [0 * x, 0 * x, 1 + 0 * x]


for width, height, ppd in [(64, 48, 67), (23, 17, 67), (40, 30, 25), (5, 3, 67)]:
    y, x = np.mgrid[0:height, 0:width]
    for name in ["shifted", "edge", "colour", "faint", "farthest"]:
        images = [np.stack(image, -1).astype(np.float32) for image in pair(name, x, y)]
        flip, _, _ = flip_evaluator.evaluate(
            *images, "LDR", inputsRGB=False, applyMagma=False, parameters={"ppd": float(ppd)})
        flip = flip[:, :, 0].astype(np.float64)
        some = [flip[0, 0], flip[height // 2, width // 3], flip[height - 1, width - 1]]
        numbers = ", ".join(f"{float(number):.6f}" for number in [flip.mean(), *some])
        print(f'("{name}", {width}, {height}, {ppd}.0, [{numbers}]),')
