"""One path on the device, looked at after every stage."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lumiere.errors import UsageError
from lumiere.overrides import Overrides
from lumiere.rendering import Render
from lumiere.scene.model import Scene
from lumiere.wavefront.batch import Batch, pixel_order
from lumiere.wavefront.state import path_fields

SLOTS = 64


@dataclass
class Vertex:
    """What a ray met, and what came of it. ``primitive`` is None where it left the scene or scattered in a body; ``program`` is the stage that dealt
    with it; vectors are float64 arrays of three.

    ``emitted`` is what the surface or the surroundings added to the sample, ``connected`` what the shadow ray did; ``offered`` is what that
    carried before it was traced, None where there was none; ``light_pdf`` and ``light_bsdf_pdf`` are the densities with which light sampling and
    BSDF sampling have its direction.
    """

    origin: np.ndarray
    direction: np.ndarray
    throughput: np.ndarray
    bsdf_pdf: float | None
    depth: int
    primitive: int | None = None
    t: float = float("inf")
    uv: tuple[float, float] = (0.0, 0.0)
    program: str = ""
    emitted: np.ndarray = field(default_factory=lambda: np.zeros(3))
    offered: np.ndarray | None = None
    shadow_direction: np.ndarray | None = None
    light_pdf: float = 0.0
    light_bsdf_pdf: float = 0.0
    connected: np.ndarray = field(default_factory=lambda: np.zeros(3))
    goes_on: bool = False


@dataclass
class Path:
    """The vertices, and the sample's radiance."""

    vertices: list[Vertex]
    radiance: np.ndarray


class _Watch:
    """The observer of a wavefront with one path in it."""

    def __init__(self, job: Render) -> None:
        self.wavefront = job.wavefront
        self.queues = job.wavefront.queues
        self.fields = path_fields(job.wavefront.buffers.features)
        self.vertices: list[Vertex] = []
        self.radiance = np.zeros(3)
        self.slot: int | None = None
        self.over = False

    def __call__(self, stage: str, launch: int, event: Any) -> None:
        if self.over or stage == "accumulate":
            return
        event.wait()
        floats, uints, tags, connects, samples = self.wavefront.snapshot()
        if self.slot is None:
            started = np.flatnonzero(tags != self.queues.index("IDLE_0"))
            if not len(started):
                return
            self.slot = int(started[0])
        state = self._state(floats, uints)
        with np.errstate(invalid="ignore"):  # of a sample that is not finite
            added = samples - self.radiance
        self.radiance = samples
        tag = self.queues[tags[self.slot]]
        if stage == "generate" and not self.vertices:
            self.vertices.append(self._vertex(state))
        elif stage == "extend":
            self._extended(state, tag)
        elif stage == "escape" and tag == "IDLE_0" and self.vertices[-1].program == "escape":
            self.vertices[-1].emitted = added
            self.over = True
        elif stage == "scatter" and self.vertices[-1].program == "scatter":
            self._goes_on(state, tag)
        elif stage.startswith("shade") and self.vertices[-1].program == "" and self.vertices[-1].primitive is not None:
            self._shaded(stage, state, tag, added, bool(connects[self.slot]))
        elif stage == "connect" and len(self.vertices) > 0:
            at = self.vertices[-2] if self.vertices[-1].program == "" and self.vertices[-1].primitive is None and len(self.vertices) > 1 \
                else self.vertices[-1]
            at.connected = at.connected + added
            self.over = not at.goes_on

    def _goes_on(self, state: dict[str, Any], tag: str) -> None:
        """From the last vertex to another, or not; then the path is over unless it waits for its shadow ray."""
        last = self.vertices[-1]
        last.goes_on = tag.startswith("EXTEND")
        if last.goes_on:
            self.vertices.append(self._vertex(state))
        elif last.offered is None:
            self.over = True

    def _state(self, floats: np.ndarray, uints: np.ndarray) -> dict[str, Any]:
        """The path's fields by name."""
        state: dict[str, Any] = {}
        at = {"float": 0, "uint": 0}
        for item in self.fields:
            words, source = ("uint", uints) if item.kind == "uint" else ("float", floats)
            values = source[at[words]:at[words] + item.size, self.slot]
            at[words] += item.size
            state[item.name] = values.astype(np.float64) if item.size == 3 else values[0].item()
        return state

    def _vertex(self, state: dict[str, Any]) -> Vertex:
        return Vertex(state["origin"], state["direction"], state["throughput"], state.get("bsdf_pdf"), state["depth"])

    def _extended(self, state: dict[str, Any], tag: str) -> None:
        vertex = self.vertices[-1]
        if tag.startswith("SHADE"):
            vertex.primitive = state["primitive"]
            vertex.t, *uv = state["hit"]
            vertex.uv = (uv[0], uv[1])
        elif tag == "ESCAPE":
            vertex.program = "escape"
        elif tag == "SCATTER":
            vertex.program, vertex.t = "scatter", state["hit"][0]
        else:
            self.over = True

    def _shaded(self, stage: str, state: dict[str, Any], tag: str, added: np.ndarray, connects: bool) -> None:
        vertex = self.vertices[-1]
        if tag.startswith("SHADE"):  # another kind's turn
            return
        vertex.program, vertex.emitted = stage, added
        if connects:
            vertex.offered, vertex.shadow_direction = state["contribution"], state["shadow_direction"]
            vertex.light_pdf, vertex.light_bsdf_pdf = state["light_pdf"], state["light_bsdf_pdf"]
        self._goes_on(state, tag)


def watch(scene: Scene, pixel: tuple[int, int], sample: int, device: str | int | None) -> tuple[Path, Render]:
    """Replays ``sample`` of ``pixel`` (x, y of the whole picture). Raises UsageError for a pixel outside what the scene renders."""
    x0, y0, x1, y1 = scene.film.window
    if not (x0 <= pixel[0] < x1 and y0 <= pixel[1] < y1):
        raise UsageError(f"--pixel: found {pixel[0]} {pixel[1]}, expected x from {x0} to {x1 - 1} and y from {y0} to {y1 - 1}")
    # The film needs no more than the radiance, and no list of pixels: a sample's numbers do not depend on either.
    plain = replace(scene, film=replace(scene.film, aovs=()), sampler=replace(scene.sampler, adaptive=None))
    job = Render(plain, device, overrides=Overrides(slots=SLOTS, compacted=False, traced=True))
    watcher = _Watch(job)
    job.wavefront.observer = watcher
    order = pixel_order(x1 - x0, y1 - y0)
    number = int(np.flatnonzero(order == (pixel[1] - y0) * (x1 - x0) + pixel[0] - x0)[0])
    job.take(Batch(number, 1, 1, sample))
    job.wavefront.finish()
    return Path(watcher.vertices, watcher.radiance), job
