"""The devices of the BSDF tests."""

from tests.bsdf.conftest import device

__all__ = ["device"]
