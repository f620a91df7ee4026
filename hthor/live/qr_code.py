"""An address as a QR code in a terminal, for whoever would else type it with a headset's pointer."""

from __future__ import annotations

from hthor.errors import MissingExtra

_BORDER = 2
"""[modules] The light edge; readers manage with less than the four of the standard, and terminals are narrow."""


def qr_code(text: str) -> str:
    """Lines of half blocks, two rows of modules in each, for a terminal of any colours: light is drawn, dark is not.

    Raises:
        MissingExtra: without the library that makes QR codes.
    """
    try:
        import segno
    except ImportError:
        raise MissingExtra("a QR code of an address", "live") from None
    light = [[not dark for dark in row] for row in segno.make(text, error="l", micro=False).matrix_iter(border=_BORDER)]
    if len(light) % 2:
        light.append([True] * len(light[0]))
    pairs = zip(light[::2], light[1::2], strict=True)
    return "\n".join("".join(" ▄▀█"[2 * up + down] for up, down in zip(*pair, strict=True)) for pair in pairs)
