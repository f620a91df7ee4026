"""What somebody with an emulated headset did, picture by picture: ``python -m benchmarks.headset_recording``.

A script plays the delivery of `benchmarks.page_headset` in a browser. Kept are, for every picture of the page, where
head and hands were in the room, which buttons and sticks were pressed, and where the body was; beside them what the
page made of it: the steering, the hand and the actions. A test repeats them without a browser, in
``web/tests/recorded.test.js``. Make the recordings again after a deliberate change of what the page makes of a headset.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.page_headset import deliver
from benchmarks.page_wearer import DEVICE, Wearer

FOLDER = Path("web/tests/recordings")
HEADSETS = (("quest2", "right", False), ("quest3", "left", True))
"""Model, the hand that answers, and whether the person sits."""
_DIGITS, _REST_MS = 4, 400

_RECORD = """() => {
  page.recorded = [];
  const { headset } = page;
  const wear = page.wear.bind(page);
  page.wear = (frame, seconds) => {
    const space = page.renderer.xr.getReferenceSpace();
    const place = (pose) => {
      if (!pose) return null;
      const { position: { x, y, z }, orientation } = pose.transform;
      return [x, y, z, orientation.x, orientation.y, orientation.z, orientation.w];
    };
    const sources = [...headset.session.inputSources].map((source) => ({
      hand: source.handedness,
      grip: place(frame.getPose(source.gripSpace, space)),
      ray: place(frame.getPose(source.targetRaySpace, space)),
      buttons: source.gamepad.buttons.map((button) => button.value),
      axes: [...source.gamepad.axes],
    }));
    const { x, y } = page.motion;
    const body = page.head ? { x, y, yaw: page.head.gaze, eye: page.self.eye } : null;
    const one = { seconds, head: place(frame.getViewerPose(space)), body, sources };
    page.recorded.push(one);
    const done = wear(frame, seconds);
    Object.assign(one, { actions: done.actions, hand: headset.hand });
    return done;
  };
  const { rig } = headset;
  const [drive, follow] = [rig.drive.bind(rig), rig.follow.bind(rig)];
  rig.drive = (stick, speed, body) => {
    const made = drive(stick, speed, body);
    Object.assign(page.recorded.at(-1), { speed, drive: { ...made } });
    return made;
  };
  rig.follow = ({ x, y }, seconds, share) => {
    page.recorded.at(-1).follow = { x, y, share };
    follow({ x, y }, seconds, share);
  };
}"""


def record(model: str, hand: str, *, seated: bool) -> dict[str, Any]:
    """Play the delivery, and keep every picture of it."""
    words = f"emulated={model}&hand={hand}&seated={'' if seated else 'no'}&plain"
    with deliver(words, hand) as (person, moments):
        page = person.page
        page.evaluate(_RECORD)
        options, space = page.evaluate("[page.headset.options, page.headset.space]")
        next(moments)
        _step_and_stroll(person)
        for _ in moments:
            pass
        return {"options": options, "space": space, "pictures": list(_changes(page.evaluate("page.recorded")))}


def _step_and_stroll(person: Wearer) -> None:
    """Take some steps in the room and back, and walk a little with the stick half-way."""
    for place in (0.1, 0.2, 0.3, 0.15, 0.0):
        person.page.evaluate(f"{DEVICE}.position.x = {place}")
        person.page.wait_for_timeout(_REST_MS)
    for tilt in (-0.5, 0.0):
        person.page.evaluate(f"{DEVICE}.controllers.{person.stick}.updateAxes('thumbstick', 0, {tilt})")
        person.page.wait_for_timeout(_REST_MS)


def _changes(pictures: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """What is not as in the picture before; numbers are rounded."""
    before: dict[str, Any] = {}
    for picture in json.loads(json.dumps(pictures), parse_float=lambda text: round(float(text), _DIGITS)):
        yield {key: value for key, value in picture.items() if key not in before or before[key] != value}
        before |= picture


def main() -> None:
    """Make the recordings."""
    options = argparse.ArgumentParser(
        prog="python -m benchmarks.headset_recording", description=__doc__.splitlines()[0]
    )
    options.add_argument("--out", type=Path, default=FOLDER, help="folder")
    out = options.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    for model, hand, seated in HEADSETS:
        made = record(model, hand, seated=seated)
        lines = ",\n".join(json.dumps(picture, separators=(",", ":")) for picture in made.pop("pictures"))
        text = json.dumps(made)[:-1] + f', "pictures": [\n{lines}\n]}}\n'
        (out / f"{model}.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
