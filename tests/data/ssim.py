"""Prints the references of src/compare/metrics (pip install scikit-image==0.26.0 scipy).

`published` is the definition of Wang et al. 2004 as their ssim_index.m computes it: the mean over
the positions where the 11 x 11 window fits; scikit-image's mean must be the same number.
"""
import numpy as np
from scipy.signal import convolve2d
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity


def pattern(x, y):
    return (x * x * 7 + y * 13 + x * y * 3) % 256 / 256


def ramp(x, y):
    return (x * 4 + y * 2) % 256 / 256


def published(a, b):
    r = np.arange(11) - 5
    window = np.exp(-(r[:, None] ** 2 + r**2) / (2 * 1.5**2))
    window /= window.sum()
    blur = lambda image: convolve2d(image, window, "valid")
    c1, c2 = 0.01**2, 0.03**2
    ma, mb = blur(a), blur(b)
    va, vb, cov = blur(a * a) - ma * ma, blur(b * b) - mb * mb, blur(a * b) - ma * mb
    return np.mean((2 * ma * mb + c1) * (2 * cov + c2) / ((ma**2 + mb**2 + c1) * (va + vb + c2)))


def line(name, a, b):
    ssim = structural_similarity(
        a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0)
    assert abs(ssim - published(a, b)) < 1e-13
    rmse, psnr = np.sqrt(mean_squared_error(a, b)), peak_signal_noise_ratio(a, b, data_range=1.0)
    print(f"{name:8} {a.shape[1]} x {a.shape[0]}: {float(rmse)!r}, {float(psnr)!r}, {float(ssim)!r}")


for width, height in [(64, 48), (11, 11), (37, 12)]:
    y, x = np.mgrid[0:height, 0:width]
    noise = (x * 31 + y * 17) % 64 / 256
    line("shifted", ramp(x, y), ramp(x + 1, y))
    line("noisy", ramp(x, y), 0.75 * ramp(x, y) + noise)
    line("other", pattern(x, y), ramp(x, y))
