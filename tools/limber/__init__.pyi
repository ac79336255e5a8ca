from limber.errors import InputError as InputError
from limber.errors import LimberError as LimberError
from limber.live.arm import Arm as Arm
from limber.live.arm_errors import FaultError as FaultError
from limber.live.arm_errors import NoStackError as NoStackError
from limber.live.arm_errors import NotReachedError as NotReachedError
from limber.live.arm_errors import RecoveryError as RecoveryError
from limber.live.arm_errors import RefusedError as RefusedError
from limber.live.arm_errors import StackLostError as StackLostError
from limber.live.arm_errors import WaitTimeoutError as WaitTimeoutError
from limber.live.arm_state import Pose as Pose
from limber.live.arm_state import State as State

__version__: str
