"""A process that runs studies: a driver that crashes ends one of them, and the next has a new process."""
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from raya.lab.laboratory import Laboratory
from raya.lab.study import studies, study_of_file

laboratory = None  # of this process: it keeps its device from one study to the next


def run_study(study, scenes, folder, options):
    """(page, device)"""
    global laboratory
    one = study_of_file(study) if study.endswith(".py") else studies()[study]
    if laboratory is None:
        more = {"no_tuned": True} if options.no_tuned else {}
        laboratory = Laboratory(folder, options.size, options.network, device=options.device, **more)
    page = one.run(laboratory, scenes)
    return page.describe(one.name, one.prose), laboratory.session.device


class Worker:
    def __init__(self):
        self._pool = None

    def run(self, *arguments):
        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        try:
            return self._pool.submit(run_study, *arguments).result()
        except BrokenProcessPool:
            self._pool = None
            raise

    def close(self):
        if self._pool is not None:
            for process in list(getattr(self._pool, "_processes", {}).values()):
                process.kill()
            self._pool.shutdown(wait=False, cancel_futures=True)
