"""What can go wrong, each as one clear line."""

from __future__ import annotations


class LumiereError(Exception):
    """An error whose text is one line for the user. ``exit_status`` is the command's."""

    exit_status = 1


class SceneError(LumiereError):
    """The scene, or a file it names, is not as the format says. ``about`` is the shape, light or file (as the scene holds it) that is wrong,
    where the text does not say where in the scene that stands."""

    exit_status = 2

    def __init__(self, text: str, about: object = None) -> None:
        super().__init__(text)
        self.about = about


class UsageError(LumiereError):
    """The command or call asks for something that cannot be."""

    exit_status = 2


class PluginError(LumiereError):
    """A plug-in that cannot be used."""

    exit_status = 2


class DeviceError(LumiereError):
    """No OpenCL device, a failed build, or too little device memory."""

    exit_status = 3
