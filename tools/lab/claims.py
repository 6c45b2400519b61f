"""The claims of the papers (claims.toml), and the verdicts on them."""
from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

import numpy as np
from raya.lab import papers
from raya.lab.statistics import LEVEL, POWER, UNTESTABLE, Test, verdicts

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

KINDS = "test", "counted", "derived", "untestable"


@dataclass(frozen=True)
class Claim:
    """A statement of a paper, in its own words (`original`) and in English. `rule` decides the verdict, or is the reason why there is none."""

    id: str
    paper: str  # its authors and year
    place: str
    original: str
    statement: str
    study: str
    kind: str  # of KINDS
    rule: str

    def __post_init__(self):
        if self.kind not in KINDS:
            raise ValueError(f"claims.toml, [{self.id}]: kind {self.kind!r}; one of {', '.join(KINDS)}")


CLAIMS = {key: Claim(key, getattr(papers, entry.pop("paper")), **entry)
          for key, entry in tomllib.loads((Path(__file__).parent / "claims.toml").read_text()).items()}


@dataclass
class Judgement:
    """A claim with our result. `test` is None for a claim that no study decides."""

    claim: Claim
    ensemble: str = ""  # the pictures that the test uses
    reason: str = ""  # our figures, as a sentence
    test: Optional[Test] = None
    verdict: str = field(default="", init=False)

    @property
    def power(self):
        """Sentence on the deviation that the test would have detected; empty for a claim without a statistical test."""
        if self.test is None or np.isnan(self.test.detectable):
            return ""
        return f"A deviation of {self.test.detectable:.2g} from the bound would be seen with {100 * POWER:.0f} %."


def judged(key, test, ensemble="", reason=""):
    return Judgement(CLAIMS[key], ensemble, reason, test)


def undecided_claims(study):
    """Judgements of the study's claims that no study decides: untestable ones and derived ones."""
    return [Judgement(claim) for claim in CLAIMS.values() if claim.study == study and claim.kind in ("derived", "untestable")]


def decide(judgements):
    """Sets the verdicts, with Holm's correction over all judgements."""
    found = verdicts({id(one): one.test for one in judgements if one.test is not None})
    for one in judgements:
        one.verdict = found.get(id(one)) or (UNTESTABLE if one.claim.kind == "untestable" else one.claim.kind)


def errors_sentence(judgements):
    """Sentence on the number of wrong verdicts to expect."""
    tests = [one for one in judgements if one.claim.kind == "test"]
    if not tests:
        return ""
    return (f"{len(tests)} of the claims are decided by statistical tests. With Holm's correction the probability that one or more of their "
            f"verdicts \"reproduced\" and \"not reproduced\" are wrong is at most {100 * LEVEL:.0f} %; without the correction "
            f"{LEVEL * len(tests):.1f} wrong ones would be expected if no claim could be decided.")
