"""Files for continuous integration (CI) results as JUnit XML, and lists of expected failures."""
import dataclasses, re
import xml.etree.ElementTree as xml


@dataclasses.dataclass
class Case:
    """A test case. outcome: PASS, FAIL, SKIP, XFAIL (failed as expected) or XPASS (passed unexpectedly); result: one line; details: lines."""
    suite: str
    name: str
    seconds: float
    outcome: str
    result: str
    details: str = ""


@dataclasses.dataclass
class ExpectedFailure:
    place: str  # "FILE:LINE"
    pattern: str
    reason: str
    link: str = ""


def name_matches(name, pattern):
    """Returns true if the name contains the pattern, in which * stands for any text."""
    return re.search(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def read_expected_failures(path):
    """Reads lines PATTERN | REASON | LINK, the link being optional; # starts a comment line. Raises ValueError with file and line."""
    failures = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        fields = [field.strip() for field in line.split("|")]
        if not line.strip() or line.strip().startswith("#"):
            continue
        if not 2 <= len(fields) <= 3 or not fields[0] or not fields[1]:
            raise ValueError(f"{path}:{number}: expected PATTERN | REASON or PATTERN | REASON | LINK")
        failures.append(ExpectedFailure(f"{path}:{number}", *fields))
    return failures


def apply_expectations(case, failures):
    """Changes the outcome of a case that is expected to fail; the first pattern that matches counts."""
    for failure in failures:
        if case.outcome in ("PASS", "FAIL") and name_matches(case.name, failure.pattern):
            why = ", ".join(filter(None, [failure.reason, failure.link]))
            passes = case.outcome == "PASS"
            case.outcome = "XPASS" if passes else "XFAIL"
            case.result = f"passed, but --expect lists it as failing ({why}): {case.result}" if passes else f"{case.result} (expected: {why})"


def unmatched(failures, names):
    """Returns a warning for each pattern that matches none of the names."""
    return [f'{failure.place}: "{failure.pattern}" matches no check' for failure in failures
            if not any(name_matches(name, failure.pattern) for name in names)]


def xml_text(text):
    """Returns the text without the control characters that XML 1.0 does not allow."""
    return re.sub("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", " ", text)


def junit_report(name, cases):
    """Returns JUnit XML with a test suite for each Case.suite. Expected failures are skipped test cases, unexpected passes are failures."""
    root = xml.Element("testsuites", name=name)
    for suite in dict.fromkeys(case.suite for case in cases):
        own = [case for case in cases if case.suite == suite]
        failures, skipped = (sum(case.outcome in kinds for case in own) for kinds in (("FAIL", "XPASS"), ("SKIP", "XFAIL")))
        element = xml.SubElement(root, "testsuite", name=xml_text(suite), tests=str(len(own)), failures=str(failures), errors="0",
                                 skipped=str(skipped), time=f"{sum(case.seconds for case in own):.3f}")
        for case in own:
            one = xml.SubElement(element, "testcase", classname=name, name=xml_text(case.name), time=f"{case.seconds:.3f}")
            if case.outcome in ("FAIL", "XPASS"):
                xml.SubElement(one, "failure", message=xml_text(case.result)).text = xml_text(case.details)
            elif case.outcome in ("SKIP", "XFAIL"):
                xml.SubElement(one, "skipped", message=xml_text(case.result))
    xml.indent(root)
    return xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"

