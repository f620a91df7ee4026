"""What one seat of a logged trial saw, drawn on request; the trial is played again for it."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, Protocol

from msgspec import Struct

from hthor.errors import UnknownName
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay.session_history import RunFiles
from hthor.guest import AgentInputs
from hthor.report.drawing import trial_trace
from hthor.report.page import camera_frames
from hthor.report.page.camera_frames import CameraFrames

HEIGHT = 480
"""[pixels] of a view; its width follows from the shape of the seat's own camera, so that nothing is stretched."""


class Overlay(Protocol):
    """Draws over a seat's view, such as what a headset shows in front of a person's eyes."""

    def draw(self, picture: Any, tick: int) -> None:
        """Draw on a picture.

        Args:
            picture: (H, W, 3) uint8, red first, the view alone without captions; to be changed in place.
            tick: of the trial.
        """
        ...


class SeatViews(Struct, frozen=True, kw_only=True, eq=False):
    """The views of one seat, with everything that is drawn over them."""

    record: TrialRecord
    seat: str
    frames: CameraFrames
    overlays: Sequence[Overlay] = ()

    @property
    def name(self) -> str:
        """The seat in words, with the body and the agent of a robot."""
        robots = {robot.seat: trial_trace.robot_words(robot) for robot in self.record.spec.robots}
        return robots.get(self.seat, trial_trace.seat_name(self.seat, self.record.paths))

    def picture(self, tick: int) -> Any:
        """The view at one of the ticks that were asked for, (H, W, 3) uint8, red first."""
        drawn = self.frames.draw(tick, self.seat)
        for overlay in self.overlays:
            overlay.draw(drawn, tick)
        return drawn


def check_seat(record: TrialRecord, seat: str) -> None:
    """Check that somebody was in this seat in the trial.

    Raises:
        UnknownName: if nobody was.
    """
    if seat not in record.paths:
        raise UnknownName("seat", seat, record.paths, "These took part in the trial.")


def see_trial(
    folder: Path,
    record: TrialRecord,
    seat: str,
    ticks: Collection[int],
    files: RunFiles,
    *,
    profile: str = "fast",
    given: AgentInputs | None = None,
    overlays: Sequence[Overlay] = (),
) -> SeatViews:
    """Play a trial of the run in ``folder`` again, and return the views of ``seat`` at ``ticks``.

    Args:
        files: the user's files that the run's folder lacks. profile: how views are drawn, fast or nice.
        given: arguments and files that the agents were given. overlays: what is drawn over each view, in order.

    Raises:
        UnknownName: if nobody was in this seat.
        RunError, HthorError: if the trial cannot be played again, see `hthor.report.page.camera_frames.render_frames`.
    """
    check_seat(record, seat)
    frames = camera_frames.film_trial(
        folder, record, ticks, files, profile=profile, seats=(seat,), height=HEIGHT, given=given
    )
    return SeatViews(record=record, seat=seat, frames=frames, overlays=tuple(overlays))
