# SPDX-License-Identifier: MIT
"""Errors: one class per problem. docs/errors.md has a section for each."""


class Error(Exception):
    """The base of all errors of g4lidar.

    `str()` is the complete text: what was being done, to what, what went wrong, what the system reported, and what to
    try.
    """

    doing: str  #: What was being done: 'opening', 'reading', ...
    subject: str  #: What it is about: a path, an option and its value.
    system_errno: int  #: The error number of the system, or 0.
    advice: str  #: What to try, a sentence.
    is_fatal: bool  #: Whether further calls on the same object cannot succeed.

    def __init__(self, message: str = "", *, doing: str = "", subject: str = "", system_errno: int = 0,
                 advice: str = "", is_fatal: bool = True) -> None:
        super().__init__(message)
        self.doing = doing
        self.subject = subject
        self.system_errno = system_errno
        self.advice = advice
        self.is_fatal = is_fatal


class BadOption(Error, ValueError):
    """The option cannot have this value."""


class NoPort(Error):
    """No serial port with a lidar was found."""


class SeveralPorts(Error):
    """More than one lidar is connected."""


class Permission(Error, PermissionError):
    """This user has no permission to open it."""


class Busy(Error):
    """Another program has it open."""


class NotSerial(Error):
    """This is not a serial port."""


class BadBaudRate(Error):
    """The port does not support this baud rate."""


class CannotConnect(Error):
    """The network address does not answer."""


class Silence(Error):
    """No byte was received."""


class Garbage(Error):
    """Bytes were received, but no valid data."""


class OtherDevice(Error):
    """The device that answers is not the model that was expected."""


class DoesNotStop(Error):
    """It continues to scan and cannot be stopped."""


class Unhealthy(Error):
    """The lidar reports that it is defective."""


class Timeout(Error, TimeoutError):
    """What was awaited did not arrive in time."""


class WrongAnswer(Error):
    """The answers do not match the request."""


class NotReached(Error):
    """The lidar does not accept this value."""


class BadSetting(Error, ValueError):
    """This model of lidar cannot be set to this value."""


class Scanning(Error):
    """Refused, because it would disturb the running scan."""


class NotScanning(Error):
    """No scan is running."""


class Reconnecting(Error):
    """The connection was lost, and the driver is reconnecting."""


class Gone(Error):
    """The port is no longer there."""


class Stalled(Error):
    """The data stopped although the port is still there."""


class BrownOut(Error):
    """The data stopped when the motor started."""


class Interference(Error):
    """Another program reads from or writes to the port."""


class ReadOnly(Error):
    """A file cannot be asked or set."""


class BadFile(Error):
    """The file contains nothing that can be used."""


class EndOfInput(Error):
    """There is no more data to read."""


class Cancelled(Error):
    """Cancelled by this program."""


class System(Error):
    """The operating system reported an error."""


class NotSupported(Error):
    """This model of lidar has no such command."""
