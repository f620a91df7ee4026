"""Ray actors on the machines of a cluster, which run session after session; needs the extra `hthor[cluster]`.

Records come back trial by trial, so that a lost machine costs only the trial that it was running.
"""

from __future__ import annotations

import signal
import socket
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from hthor import code_identity, installation
from hthor.errors import HthorError, MissingExtra
from hthor.eval.records.trial_log import BEAT_S
from hthor.eval.runner.engines import ATTEMPTS, LIMIT_S, PausableClock, Queue, SessionFailed
from hthor.eval.runner.messages import Failed, Finished, News, RunnerFactory, SessionAbandoned, TrialDone
from hthor.eval.runner.worker import ONE_THREAD, SessionPlayer

if TYPE_CHECKING:
    from hthor.trials.sessions import Session

_CONNECT_S = 10.0


class Engine:
    """Runs sessions in Ray actors, as many as the cluster has room for.

    Args:
        jobs: how many actors; None for one per CPU of the cluster, or as many as share its GPUs.
        address: of the cluster that this machine belongs to, such as ``10.0.0.1:6379``; empty for the one that is
            here, or a new one of this machine alone.

    Raises:
        MissingExtra: when Ray is not installed.
        HthorError: for the address of a Ray client, which cannot stream trials one by one.
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
        self._failed_starts = 0

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """See `hthor.eval.runner.engines.Engine`."""
        with self._connected():
            queue, jobs, actors = Queue(sessions), self._jobs or self._room(), self._actor_class()
            workers: list[_Worker] = []
            try:
                while queue or any(one.task for one in workers):
                    workers = [one for one in workers if not one.dead]
                    while len(workers) < min(jobs, len(queue) + sum(1 for one in workers if one.task)):
                        workers.append(_Worker(self._ray, actors.remote(make)))
                    for worker in workers:
                        if queue and worker.ready and not worker.task:
                            worker.give(*queue.take(), self._clock.now())
                    yield from self._listen(workers, queue)
                    if self._draining:
                        queue.clear()
            finally:
                for worker in workers:
                    worker.end()

    def drain(self) -> None:
        """See `hthor.eval.runner.engines.Engine`."""
        self._draining = True

    def _listen(self, workers: list[_Worker], queue: Queue) -> Iterator[News | None]:
        awaited = {worker.awaited: worker for worker in workers if worker.awaited is not None}
        ready, _ = self._ray.wait(list(awaited), num_returns=1, timeout=BEAT_S, fetch_local=False)
        now = self._clock.now()
        if not ready:
            yield None
        for worker in workers:
            if worker.task and worker.awaited not in ready and now - worker.since > self._limit_s:
                worker.give_up(self._limit_s)
        for one in ready:
            worker = awaited[one]
            news, worker.since = worker.receive(), now
            if isinstance(news, Failed):
                raise SessionFailed(news)
            if news is not None:
                yield news
            elif worker.dead and worker.task:
                yield queue.again(*worker.task, worker.cause)
                worker.task = None
            if self._draining and isinstance(news, TrialDone):
                worker.task, worker.dead = None, True
                worker.end()
            self._failed_starts = self._failed_starts + 1 if worker.dead and not worker.ready else 0
            if self._failed_starts >= ATTEMPTS:
                raise HthorError(f"workers do not start on the Ray cluster: {worker.cause}. Is hthor installed there?")

    def _actor_class(self) -> Any:
        """The class of the actors, with the resources that each needs."""
        return self._ray.remote(
            num_cpus=1,
            num_gpus=self._gpus,
            max_restarts=0,
            scheduling_strategy="SPREAD",
            runtime_env={"env_vars": {**ONE_THREAD, "PYTHONHASHSEED": "0"}},
        )(Actor)

    def _room(self) -> int:
        """How many actors the cluster has room for; raises HthorError when it has none."""
        resources = self._ray.cluster_resources()
        room = int(resources.get("CPU", 0.0))
        if self._gpus:
            room = min(room, int(resources.get("GPU", 0.0) / self._gpus))
        if not room:
            wanted = f"a CPU and {self._gpus:g} of a GPU" if self._gpus else "a CPU"
            raise HthorError(f"the Ray cluster has no room: a worker needs {wanted}. Look at 'ray status'.")
        return room

    @contextmanager
    def _connected(self) -> Iterator[None]:
        """Connect to the cluster. Signal handlers are kept: with Ray's own, SIGTERM would end the process at once."""
        connects = not self._ray.is_initialized()
        if connects:
            kept = signal.getsignal(signal.SIGTERM)
            try:
                self._check_address()
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
            if connects:
                self._ray.shutdown()

    def _check_address(self) -> None:
        """Check that something answers at the address: Ray itself would wait for minutes."""
        host, colon, port = self._address.rpartition(":")
        if colon:
            socket.create_connection((host, int(port)), timeout=_CONNECT_S).close()


class _Worker:
    """An actor, the result that is awaited from it, and the session that it runs."""

    def __init__(self, ray: Any, actor: Any) -> None:
        self._ray, self._actor = ray, actor
        self.awaited: Any = self._actor.describe.remote()
        self.ready = self.dead = False
        self.task: tuple[Session, int] | None = None
        self.since = 0.0
        self.cause = ""

    def give(self, session: Session, attempt: int, now: float) -> None:
        """Give the actor a session."""
        self.task, self.since = (session, attempt), now
        self.awaited = self._actor.run.options(num_returns="streaming").remote(session)

    def receive(self) -> News | None:
        """The next message; None when the actor has only started, or died.

        Raises:
            HthorError: when the actor's machine has another version of hthor.
        """
        try:
            if not self.ready:
                _compare(*self._ray.get(self.awaited))
                self.ready, self.awaited = True, None
                return None
            news: News = self._ray.get(next(self.awaited))
        except (self._ray.exceptions.RayError, StopIteration) as error:
            lines = str(error).strip().splitlines() or [""]
            self.dead = True
            self.cause = self.cause or f"{type(error).__name__} of Ray: {lines[0][:200]}".rstrip(": ")
            self.end()
            return None
        if isinstance(news, (Finished, SessionAbandoned)):
            self.task = self.awaited = None
        return news

    def give_up(self, after_s: float) -> None:
        """Kill an actor that is stuck; `receive` notices."""
        self.cause = f"the limit of {after_s:.0f} s for a trial"
        self.end()

    def end(self) -> None:
        """End the actor, and the agents that it started."""
        with suppress(Exception):  # it may be gone already, or the whole cluster
            self._ray.kill(self._actor)


class Actor:
    """A worker on a machine of the cluster."""

    def __init__(self, make: RunnerFactory) -> None:
        code_identity.keep_compiled()
        self._player = SessionPlayer(make)

    def describe(self) -> tuple[str, str, dict[str, str]]:
        """This machine's name, the hash of its hthor, and the versions of its libraries."""
        return socket.gethostname(), installation.sha256(), installation.versions()

    def run(self, session: Session) -> Iterator[News]:
        """See `hthor.eval.runner.worker.SessionPlayer`."""
        yield from self._player.run(session)


def _compare(host: str, code: str, versions: dict[str, str]) -> None:
    """Check that a machine has the same hthor as this one: other code could give other trials."""
    here = {"code": installation.sha256()[:10], **installation.versions()}
    there = {"code": code[:10], **versions}
    names = [name for name in here if there.get(name) != here[name]]
    if different := [f"{name} is {there.get(name)} there and {here[name]} here" for name in names]:
        raise HthorError(
            f"{host} of the Ray cluster does not match this machine: {'; '.join(different)}. Install the same on "
            "all machines."
        )
