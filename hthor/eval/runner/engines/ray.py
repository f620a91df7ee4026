"""Actors on the machines of a Ray cluster, which play session after session; needs the extra `hthor[cluster]`.

Records come back trial by trial, so that a machine that is lost costs only the trial that it was playing.
"""

from __future__ import annotations

import signal
import socket
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from hthor import code_identity, installation
from hthor.errors import HthorError, MissingExtra
from hthor.eval.runner.engines import RunnerFactory, SessionFailed
from hthor.eval.runner.messages import Failed, Finished, News, SessionAbandoned, TrialDone
from hthor.eval.runner.queue import ATTEMPTS, BEAT_S, LIMIT_S, PausableClock, Queue
from hthor.eval.runner.worker import ONE_THREAD, SessionPlayer

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session

_KNOCK_S = 10.0


class Engine:
    """Has actors play, as many as the cluster has room for.

    Args:
        jobs: how many actors; None is one a CPU of the cluster, or as many as share its GPUs.
        address: of the cluster that this machine belongs to, such as ``10.0.0.1:6379``; empty for the one that is
            here, or a new one of this machine alone.
        gpus: how much of a GPU each actor needs, such as 0.25.
        limit_s: how long [s] an actor may play a trial before it counts as stuck.

    Raises:
        MissingExtra: when Ray is not installed.
        HthorError: for the address of a Ray client, which cannot hear of trials one by one.
    """

    def __init__(
        self, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
    ) -> None:
        try:
            import ray
        except ImportError:
            raise MissingExtra("--engine ray", "cluster") from None
        if "://" in address or (":" in address and not address.rpartition(":")[2].isdecimal()):
            raise HthorError(f"--address {address}: expected HOST:PORT. Give the command on a machine of the cluster.")
        self._ray: Any = ray
        self._jobs, self._address, self._gpus = jobs, address, gpus
        self._limit_s, self._clock, self._draining = limit_s, PausableClock(), False
        self._stillborn = 0

    def perform(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """See `hthor.eval.runner.engines.Engine`."""
        with self._connected():
            queue, jobs, cast = Queue(sessions), self._jobs or self._room(), self._cast()
            hands: list[_Hand] = []
            try:
                while queue or any(hand.task for hand in hands):
                    hands = [hand for hand in hands if not hand.dead]
                    while len(hands) < min(jobs, len(queue) + sum(1 for hand in hands if hand.task)):
                        hands.append(_Hand(self._ray, cast.remote(make)))
                    for hand in hands:
                        if queue and hand.ready and not hand.task:
                            hand.give(*queue.take(), self._clock.now())
                    yield from self._listen(hands, queue)
                    if self._draining:
                        queue.clear()
            finally:
                for hand in hands:
                    hand.end()

    def drain(self) -> None:
        """See `hthor.eval.runner.engines.Engine`."""
        self._draining = True

    def _listen(self, hands: list[_Hand], queue: Queue) -> Iterator[News | None]:
        awaited = {hand.awaited: hand for hand in hands if hand.awaited is not None}
        ready, _ = self._ray.wait(list(awaited), num_returns=1, timeout=BEAT_S, fetch_local=False)
        now = self._clock.now()
        if not ready:
            yield None
        for hand in hands:
            if hand.task and hand.awaited not in ready and now - hand.since > self._limit_s:
                hand.give_up(self._limit_s)
        for one in ready:
            hand = awaited[one]
            news, hand.since = hand.hear(), now
            if isinstance(news, Failed):
                raise SessionFailed(news)
            if news is not None:
                yield news
            elif hand.dead and hand.task:
                yield queue.again(*hand.task, hand.cause)
                hand.task = None
            if self._draining and isinstance(news, TrialDone):
                hand.task, hand.dead = None, True
                hand.end()
            self._stillborn = self._stillborn + 1 if hand.dead and not hand.ready else 0
            if self._stillborn >= ATTEMPTS:
                raise HthorError(f"workers do not start on the Ray cluster: {hand.cause}. Is hthor installed there?")

    def _cast(self) -> Any:
        """The actors' class, with what each needs of a machine."""
        return self._ray.remote(
            num_cpus=1,
            num_gpus=self._gpus,
            max_restarts=0,
            scheduling_strategy="SPREAD",
            runtime_env={"env_vars": {**ONE_THREAD, "PYTHONHASHSEED": "0"}},
        )(Actor)

    def _room(self) -> int:
        """How many actors the cluster has room for.

        Raises:
            HthorError: when it has none.
        """
        there = self._ray.cluster_resources()
        room = int(there.get("CPU", 0.0))
        if self._gpus:
            room = min(room, int(there.get("GPU", 0.0) / self._gpus))
        if not room:
            wanted = f"a CPU and {self._gpus:g} of a GPU" if self._gpus else "a CPU"
            raise HthorError(f"the Ray cluster has no room: a worker needs {wanted}. Look at 'ray status'.")
        return room

    @contextmanager
    def _connected(self) -> Iterator[None]:
        """Be part of the cluster. Signals stay ours: Ray would have SIGTERM end the process at once."""
        ours = not self._ray.is_initialized()
        if ours:
            kept = signal.getsignal(signal.SIGTERM)
            try:
                self._knock()
                self._ray.init(address=self._address or None, log_to_driver=False, logging_level="ERROR")
            except (OSError, ValueError, RuntimeError) as error:
                problem = str(error).strip().splitlines()[0].rstrip(".")
                raise HthorError(
                    f"--engine ray --address '{self._address}': {problem}. Look at 'ray status'."
                ) from None
            with suppress(ValueError):  # not in the main thread, where signals would come
                signal.signal(signal.SIGTERM, kept)
        try:
            yield
        finally:
            if ours:
                self._ray.shutdown()

    def _knock(self) -> None:
        """See that somebody is at the address: Ray itself would wait for minutes."""
        host, colon, port = self._address.rpartition(":")
        if colon:
            socket.create_connection((host, int(port)), timeout=_KNOCK_S).close()


class _Hand:
    """An actor, what is awaited of it, and the session it has in hand."""

    def __init__(self, ray: Any, actor: Any) -> None:
        self._ray, self._actor = ray, actor
        self.awaited: Any = self._actor.greet.remote()
        self.ready = self.dead = False
        self.task: tuple[Session, int] | None = None
        self.since = 0.0
        self.cause = ""

    def give(self, session: Session, attempt: int, now: float) -> None:
        """Hand over a session."""
        self.task, self.since = (session, attempt), now
        self.awaited = self._actor.play.options(num_returns="streaming").remote(session)

    def hear(self) -> News | None:
        """What the actor has to say, None when it only greeted, or died.

        Raises:
            HthorError: when its machine has another hthor.
        """
        try:
            if not self.ready:
                _compare(*self._ray.get(self.awaited))
                self.ready, self.awaited = True, None
                return None
            news: News = self._ray.get(next(self.awaited))
        except (self._ray.exceptions.RayError, StopIteration) as error:
            told = str(error).strip().splitlines() or [""]
            self.dead = True
            self.cause = self.cause or f"{type(error).__name__} of Ray: {told[0][:200]}".rstrip(": ")
            self.end()
            return None
        if isinstance(news, (Finished, SessionAbandoned)):
            self.task = self.awaited = None
        return news

    def give_up(self, after_s: float) -> None:
        """End an actor that is stuck; `hear` notices."""
        self.cause = f"the limit of {after_s:.0f} s for a trial"
        self.end()

    def end(self) -> None:
        """End the actor, and with it the agents that it started."""
        with suppress(Exception):  # it may be gone already, or the whole cluster
            self._ray.kill(self._actor)


class Actor:
    """A worker on some machine."""

    def __init__(self, make: RunnerFactory) -> None:
        code_identity.keep_compiled()
        self._player = SessionPlayer(make)

    def greet(self) -> tuple[str, str, dict[str, str]]:
        """This machine's name, and which hthor it has with which libraries."""
        return socket.gethostname(), installation.sha256(), installation.versions()

    def play(self, session: Session) -> Iterator[News]:
        """See `hthor.eval.runner.worker.SessionPlayer`."""
        yield from self._player.play(session)


def _compare(host: str, code: str, versions: dict[str, str]) -> None:
    """See that a machine has the hthor that this one has: other code would give other trials."""
    here = {"code": installation.sha256()[:10], **installation.versions()}
    there = {"code": code[:10], **versions}
    other = [
        f"{name} is {there.get(name)} there and {here[name]} here" for name in here if there.get(name) != here[name]
    ]
    if other:
        raise HthorError(
            f"{host} of the Ray cluster is no match: {'; '.join(other)}. Install the same on all machines."
        )
