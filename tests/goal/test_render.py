"""Rendering to a goal: what is stated holds, pictures are those of the same samples, adaptive batches change no bit."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from lumiere import api
from lumiere.errors import UsageError
from lumiere.goal.error import LUMINANCE, relative_error
from lumiere.rendering import Render
from lumiere.scene.model import Adaptive, Scene

SCENE: dict[str, Any] = {"scene": {
    "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]}, "film": {"width": 12, "height": 10}, "integrator": {"max_depth": 4},
    "geometry": [{"type": "plane"}, {"type": "sphere", "position": [0, 0.5, 0], "radius": 0.5, "material": {"type": "dielectric"}}],
    "lights": [{"type": "area", "position": [1, 3, 0], "radius": 0.5, "radiance": 12}, {"type": "environment", "radiance": 0.2}]}}


def _scene(**sampler: Any) -> Scene:
    scene = api.load(SCENE)
    return dataclasses.replace(scene, sampler=dataclasses.replace(scene.sampler, **sampler))


def _adaptive(target: float, max_spp: int, **sampler: Any) -> Scene:
    return _scene(adaptive=Adaptive(target_error=target, max_spp=max_spp), **sampler)


def test_the_true_error_is_below_the_target(device: Any) -> None:
    """19 or more of 20 seeds of either sampling; a stop at the target instead of below it would fail in half of them."""
    reference = Render(_scene(spp=1 << 14, seed=77), device.name)
    reference.run()
    known = reference.image({}).pixels.astype(np.float64) @ LUMINANCE
    for scene in (_scene(), _adaptive(0.04, 1 << 12)):
        job = Render(scene, device.name)
        errors = []
        for seed in range(20):
            job.restart(seed)
            job.run(target_error=0.04, spp_limit=1 << 12)
            assert job.outcome is not None and job.outcome.reached
            errors.append(relative_error(job.image({}).pixels.astype(np.float64) @ LUMINANCE, known))
        assert np.count_nonzero(np.array(errors) <= 0.04) >= 19, errors


def test_the_picture_is_that_of_as_many_samples(device: Any) -> None:
    image = api.render(_scene(), target_error=0.3, device=device.name)
    assert image.record["error"]["reached"]
    assert image.aovs["error"].shape == image.pixels.shape[:2]
    again = api.render(_scene(spp=image.record["spp"]), device=device.name)
    assert np.array_equal(image.pixels, again.pixels)


def test_the_limit_is_kept_and_said(device: Any) -> None:
    image = api.render(_scene(), target_error=1e-4, spp=20, device=device.name)
    assert image.record["spp"] == 20 and not image.record["error"]["reached"]
    image = api.render(_adaptive(1e-4, 40), device=device.name)
    assert image.record["spp"] == 40 and not image.record["error"]["reached"]


def test_adaptive_pixels_hold_the_samples_of_their_count(device: Any) -> None:
    """Whatever rounds and batches they came in: each pixel is that of a uniform render of as many samples, bit by bit."""
    scene = _adaptive(0.03, 4096)
    scene.film.aovs = ("sample_count",)
    job = Render(scene, device.name)
    job.wavefront.policy = dataclasses.replace(job.wavefront.policy, fill=1 << 12)  # more would be all pixels of this picture
    job.run()
    image = job.image({})
    counts = image.aovs["sample_count"]
    assert len(np.unique(counts)) > 1
    for n in np.unique(counts):
        uniform = api.render(_scene(spp=int(n)), device=device.name)
        assert np.array_equal(image.pixels[counts == n], uniform.pixels[counts == n])


def test_the_batch_size_changes_no_bit(device: Any) -> None:
    pictures = []
    for batch in (None, 5000):
        job = Render(_adaptive(0.005, 2048), device.name)
        if batch is not None:
            job.wavefront.policy = dataclasses.replace(job.wavefront.policy, batch=batch)
        job.run()
        pictures.append(job.image({}).pixels)
    assert np.array_equal(*pictures)


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_a_target_must_be_above_zero(value: float) -> None:
    with pytest.raises(UsageError, match="target_error"):
        api.render(SCENE, target_error=value)
