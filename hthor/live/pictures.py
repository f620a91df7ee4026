"""Pictures that go to a page."""

from hthor.types.sensors import RgbImage

_QUALITY = 80
"""[percent] Quality of JPEG pictures. Our choice: no artefacts that a reader of a message would notice."""


def to_jpeg(picture: RgbImage, quality: int = _QUALITY) -> bytes:
    """A picture, (H, W, 3) uint8, red first, as a JPEG file of a quality [percent]."""
    import cv2

    found, data = cv2.imencode(".jpg", picture[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert found
    return bytes(data.tobytes())
