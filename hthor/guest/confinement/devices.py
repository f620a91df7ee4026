"""The GPUs of a machine as files, for agents that ask for some."""

from __future__ import annotations

from pathlib import Path

VARIABLES = ("CUDA_VISIBLE_DEVICES", "CUDA_DEVICE_ORDER", "NVIDIA_VISIBLE_DEVICES", "NVIDIA_DRIVER_CAPABILITIES")
"""What in the environment says which of them are meant."""
FACTS = ("/proc/driver/nvidia", "/sys/bus/pci", "/sys/devices", "/sys/module/nvidia")
"""What a driver reads of the machine."""


def gpus(root: str = "/dev") -> tuple[str, ...]:
    """The files of the machine's GPUs."""
    return tuple(sorted(str(path) for path in Path(root).glob("nvidia*")))
