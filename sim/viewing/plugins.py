"""Parts of MuJoCo's viewer that play a recorded walk, with marks in its scene.

The viewer runs in a thread of its own; the playback is shared between the two.
"""

import time

import mujoco
import numpy as np
from mujoco.studio import messages, plugin, sim
from mujoco.studio.dear_imgui import dear_imgui as imgui

from sim import palette
from sim.pictures.clock import Playback
from sim.pictures.legend import entries
from sim.runs.run import Run
from sim.viewing.marks import Marks, middle_and_extent

PERCENT = 100.0
CORNER = (330.0, 60.0)  # of the panel, beside the viewer's own [pixels]
AGAIN = 1.0  # [s] after which controls are sent again to a viewer that came late
FLAGS = (mujoco.mjtVisFlag.mjVIS_CONTACTPOINT, mujoco.mjtVisFlag.mjVIS_CONTACTFORCE)


class Player(plugin.SimPlugin):
    """Shows the recorded states one after another; nothing is stepped.

    Contact forces follow from position, speed and command, so they are those of the
    walk.
    """

    def __init__(self, walk: Run, playback: Playback) -> None:
        self._walk, self._playback = walk, playback
        self._clock = time.perf_counter()
        self._sent: tuple[bool, float] | None = None
        self._send_at = self._clock

    @messages.handler
    def on_step(self, event: messages.StepEvent) -> bool:
        """Let time pass and put the model in its place."""
        now = time.perf_counter()
        self._playback.pass_by(now - self._clock)
        self._clock = now
        walk, data = self._walk, event.data
        row = row_at(walk, self._playback.time)
        data.time = walk.time[row]
        data.qpos[:], data.qvel[:] = walk.qpos[row], walk.qvel[row]
        data.ctrl[:] = walk.ctrl[row]
        # The viewer has buttons of its own, which follow what is changed on the panel.
        state = self._playback.paused, self._playback.speed
        if state != self._sent or self._clock > self._send_at:
            self._sent, self._send_at = state, self._clock + AGAIN
            names = sim.PauseState
            paused = names.NORMAL_PAUSED if state[0] else names.UNPAUSED
            controls = {"pause_state": paused, "speed": PERCENT * state[1]}
            self.handle.send_to_viewer(messages.StepControlSnapshot(**controls))
        time.sleep(0.008)  # between states that are sent
        return True

    @messages.handler
    def on_control(self, event: messages.StepControlSnapshot) -> bool:
        """Follow the viewer's own buttons for pause and speed."""
        self._playback.paused = event.pause_state != sim.PauseState.UNPAUSED
        self._playback.speed = event.speed / PERCENT
        return True

    @messages.handler
    def on_pause(self, event: messages.RequestPauseEvent) -> bool:
        """Pause or go on."""
        self._playback.paused = event.pause_state != sim.PauseState.UNPAUSED
        return True

    @messages.handler
    def on_single_step(self, event: messages.SingleStepEvent) -> bool:
        """Go to the next recorded moment."""
        times = self._walk.time
        row = row_at(self._walk, self._playback.time) + 1
        self._playback.go_to(float(times[min(row, len(times) - 1)]))
        return True

    @messages.handler
    def on_reset(self, event: messages.ResetEvent) -> bool:
        """Begin again."""
        self._playback.go_to(0.0)
        return True

    @messages.handler
    def on_threads(self, event: messages.ThreadPoolEvent) -> bool:
        """Ask for no threads, with too many of which the process would end."""
        return True


class Scene(plugin.ViewerPlugin):
    """Draws the marks of the moment that the viewer shows."""

    def __init__(self, walk: Run, marks: Marks) -> None:
        self._walk, self._marks = walk, marks

    @messages.handler
    def on_model(self, event: messages.PostModelEvent) -> None:
        """Turn contact forces on and look at the whole walk."""
        for flag in FLAGS:
            self.viewer.vis_options.flags[flag] = 1
        walk, camera = self._walk, self.viewer.camera
        middle, extent = middle_and_extent(walk)
        camera.lookat[:] = (*middle, 0.0)
        camera.distance = 4.0 * walk.reach + extent
        camera.azimuth, camera.elevation = 120.0, -40.0

    @messages.handler
    def on_update(self, event: messages.UpdateEvent) -> None:
        """Draw the marks of the present row."""
        row = row_at(self._walk, self.viewer.data.time)
        self.viewer.extra_geoms[:] = self._marks.at(row)


class Panel(plugin.ViewerPlugin):
    """A window with the time of the walk, play, pause, speed, and a key of colours."""

    def __init__(self, walk: Run, playback: Playback) -> None:
        self._playback = playback
        *_, last = walk.drawn
        ghost = palette.PREDICTED[last].colour
        self._key = [*entries(walk), ("robot where it is predicted", ghost)]

    @messages.handler
    def on_gui(self, event: messages.BuildGuiEvent) -> None:
        """Draw the window and do what is asked for in it."""
        playback = self._playback
        imgui.SetNextWindowPos(imgui.Vec2(*CORNER), imgui.Cond.Once)
        imgui.Begin("Walk")
        moved, moment = imgui.SliderFloat(
            "time [s]", playback.time, 0.0, playback.end, "%.1f"
        )
        if moved:
            playback.go_to(moment)
        if imgui.Button("play" if playback.paused else "pause"):
            playback.paused = not playback.paused
        for speed in (0.25, 1.0, 2.0, 4.0, 8.0, 16.0):
            imgui.SameLine()
            if imgui.Button(f"{speed:g}x"):
                playback.speed = speed
        imgui.Separator()
        for label, colour in self._key:
            imgui.TextColored(imgui.Vec4(*colour.rgba()), label)
        imgui.End()


def row_at(walk: Run, moment: float) -> int:
    """Row of the trajectory that shows a moment [s]."""
    return min(int(np.searchsorted(walk.time, moment - 1e-9)), len(walk.time) - 1)
