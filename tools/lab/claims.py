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
    """A statement of a paper, in the paper's words (`original`) and in English. `rule` decides the verdict, or states why there is none."""

    id: str
    paper: str  # authors and year
    place: str  # section, table or figure of the paper
    original: str
    statement: str
    study: str  # name of the study that judges the claim
    kind: str  # one of KINDS
    rule: str

    def __post_init__(self):
        if self.kind not in KINDS:
            raise ValueError(f"claims.toml, [{self.id}]: kind {self.kind!r}; one of {', '.join(KINDS)}")


def read_toml(name, **values):
    """Returns the contents of a data file of the laboratory, in which {names} are replaced by values."""
    text = (Path(__file__).parent / name).read_text()
    for key, value in values.items():
        text = text.replace(f"{{{key}}}", value)
    return tomllib.loads(text)


CLAIMS = {key: Claim(key, getattr(papers, paper), study=study, **{"kind": "test", **entry})
          for paper, studies in read_toml("claims.toml").items() for study, entries in studies.items() for key, entry in entries.items()}


@dataclass
class Judgement:
    """A claim with our result. `test` is None for a derived or untestable claim."""

    claim: Claim
    ensemble: str = ""  # the pictures that the test uses
    reason: str = ""  # a sentence with our figures
    test: Optional[Test] = None
    verdict: str = field(default="", init=False)

    @property
    def power(self):
        """A sentence on the deviation that the test can detect; empty for a claim without a statistical test."""
        if self.test is None or np.isnan(self.test.detectable):
            return ""
        return f"A deviation of {self.test.detectable:.2g} from the bound would be detected with a probability of {100 * POWER:.0f} %."


def judged(key, test, ensemble="", reason=""):
    """Returns the judgement of a claim. test: None if the claim is derived or untestable."""
    claim = CLAIMS[key]
    if test is not None and claim.kind not in ("test", "counted"):
        raise ValueError(f"claim '{key}' is {claim.kind}: it takes no test")
    return Judgement(claim, ensemble, reason, test)


def undecided_claims(study, judgements):
    """Returns judgements on the study's derived and untestable claims that `judgements` does not contain."""
    known = {judgement.claim.id for judgement in judgements}
    return [Judgement(claim) for claim in CLAIMS.values()
            if claim.study == study and claim.kind in ("derived", "untestable") and claim.id not in known]


def decide(judgements):
    """Sets the verdicts of the judgements, with Holm's correction over all of their tests."""
    found = verdicts({id(judgement): judgement.test for judgement in judgements if judgement.test is not None})
    for judgement in judgements:
        judgement.verdict = found.get(id(judgement)) or (UNTESTABLE if judgement.claim.kind == "untestable" else judgement.claim.kind)


def errors_sentence(judgements):
    """Returns a sentence on the expected number of wrong verdicts; empty without a statistical test."""
    tests = [judgement for judgement in judgements if judgement.claim.kind == "test"]
    if not tests:
        return ""
    return (f"{len(tests)} of the claims are decided by statistical tests. With Holm's correction the probability that one or more verdicts "
            f"\"reproduced\" or \"not reproduced\" of these tests are wrong is at most {100 * LEVEL:.0f} %. Without it, "
            f"{LEVEL * len(tests):.1f} wrong verdicts would be expected if every tested quantity were exactly at the bound of its rule.")
