"""Pictures that go to a page."""

from hthor.types.sensors import RgbImage

_QUALITY = 80
"""[percent] Quality of JPEG pictures. Our choice: no artefacts that a reader of a message would notice."""


def to_jpeg(picture: RgbImage) -> bytes:
    """A picture, (H, W, 3) uint8, red first, as a JPEG file."""
    import cv2

    found, data = cv2.imencode(".jpg", picture[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    assert found
    return bytes(data.tobytes())
