"""The claims of the papers (claims.toml), and the verdicts on them."""
from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

import numpy as np
from raya.lab import papers
from raya.lab.statistics import LEVEL, NOT_REPRODUCED, POWER, REPRODUCED, Test

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

KINDS = "test", "counted", "derived", "untestable"
# Negative controls: mappings with which a rule on the cyclic mapping should not hold, as options of raya.loads().
CONTROLS = {"random permutation": {"mapping": "random:1"}, "p = 5": {"offset": 5}}


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
    history: str = ""  # if the rule was changed after a result was known: when, and the verdict by the earlier rule

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
    """A claim with our result. `test` is None for a derived or untestable claim. controls: the rule's tests of CONTROLS instead of the cyclic mapping."""

    claim: Claim
    ensemble: str = ""  # the pictures that the test uses
    reason: str = ""  # a sentence with our figures
    test: Optional[Test] = None
    controls: dict = field(default_factory=dict)
    verdict: str = field(default="", init=False)
    conditions: str = field(default="", init=False)  # the verdict under each condition

    @property
    def power(self):
        """A sentence on the deviation that the test can detect; empty for a claim without a statistical test."""
        if self.test is None or np.isnan(self.test.detectable):
            return ""
        return f"A deviation of {self.test.detectable:.2g} from the bound would be detected with a probability of {100 * POWER:.0f} %."

    def passes(self, control):
        """Returns whether a control fulfils the rule: "yes", "no", "undecided", or "n/a" for a rule that does not depend on the mapping."""
        test = self.controls.get(control)
        return {REPRODUCED: "yes", NOT_REPRODUCED: "no"}.get(test.verdict(), "undecided") if test else "n/a"

    @property
    def qualification(self):
        """Which controls also fulfil the rule of a reproduced claim; otherwise empty."""
        passing = [control for control in self.controls if self.passes(control) == "yes"]
        return f"does not discriminate, {' and '.join(passing)} fulfil it, too" if passing and self.verdict == REPRODUCED else ""


def judged(key, test, ensemble="", reason="", controls=None):
    """Returns the judgement of a claim. test: None if the claim is derived or untestable."""
    claim = CLAIMS[key]
    if test is not None and claim.kind not in ("test", "counted"):
        raise ValueError(f"claim '{key}' is {claim.kind}: it takes no test")
    return Judgement(claim, ensemble, reason, test, controls or {})


def controlled(key, rule, tested, controls, ensemble, reason):
    """Returns the judgement of a claim whose test is rule(values): `tested` has the values of the cyclic mapping, `controls` those of some CONTROLS."""
    return judged(key, rule(tested), ensemble, reason, {name: rule(values) for name, values in controls.items()})


def undecided_claims(study, judgements):
    """Returns judgements on the study's derived and untestable claims that `judgements` does not contain."""
    known = {judgement.claim.id for judgement in judgements}
    return [Judgement(claim) for claim in CLAIMS.values()
            if claim.study == study and claim.kind in ("derived", "untestable") and claim.id not in known]


TESTS = sum(claim.kind == "test" for claim in CLAIMS.values())


def decide(judgements, tests=TESTS):
    """Sets the verdicts of the judgements, with Bonferroni's correction for all tests of claims.toml: a verdict does not depend on which other studies
    run."""
    for judgement in judgements:
        judgement.verdict = judgement.test.verdict(LEVEL / tests) if judgement.test else judgement.claim.kind
        by_case = judgement.test.case_verdicts(LEVEL / tests) if judgement.test else {}
        judgement.conditions = " ".join(f"{verdict.capitalize()}: {'; '.join(name for name, one in by_case.items() if one == verdict)}."
                                        for verdict in dict.fromkeys(by_case.values()))


def errors_sentence(judgements):
    """Returns a sentence on the expected number of wrong verdicts; empty without a statistical test."""
    tests = sum(judgement.claim.kind == "test" for judgement in judgements)
    if not tests:
        return ""
    return (f"{tests} of the claims are decided by statistical tests. The probability that one or more of the verdicts on the {TESTS} tested claims of "
            f"claims.toml are wrong is at most {100 * LEVEL:.0f} % (Bonferroni, whichever studies run). Without the correction, {LEVEL * tests:.1f} "
            "wrong verdicts would be expected here if every tested quantity were exactly at the bound of its rule.")
