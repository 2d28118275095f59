"""The panels of ParaView: every property says what it is, in which range and unit, stands under a title, has the class's own
default, and what hides it exists.

panels.py SOURCES
"""

import math
import pathlib
import re
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import lamella

SOURCES = pathlib.Path(sys.argv[1])
# Numbers without a unit: shares, strains, ratios, counts, values in units of the data.
PURE = {
    "Aspect", "Barrier", "BinWidth", "CalmFrom", "CellsPerNode", "Conductivities", "ConductivitiesAcross", "CriticalStretches",
    "Damping", "DiameterRatio", "EarlyEnd", "EnergyRatio", "FirstSpeed", "Friction", "Horizon", "InitialValue", "InletValue",
    "LateralRatio", "LateralStrain", "LeastSolidity", "LeastSpeed", "Level", "MaximumStrain", "MostSpeed", "Multiples", "Offset",
    "OutletValue", "PackingFraction", "PlateauRange", "PoissonsRatio", "Prominence", "Range", "Reach", "RingPosition", "Saturation",
    "Scatter", "Share", "Smoothing", "Softness", "SolidFraction", "StartRate", "StartShare", "StatesAtStrains", "StepShare",
    "StiffnessRange", "StopShare", "Strain", "StrainStep", "TailShare", "Threshold", "Tolerance", "TransversePoissonsRatio",
    "TravelTimes", "VesselShare", "Width", "Window",
}
DEFAULTS_FOR_A_START = {  # materials that make the first Apply work, where the class has none
    "YoungsModuli", "CriticalStretches", "Conductivities", "Diffusivities"}


def numbers(text):
    return [float(value) for value in re.split(r"[\s;]+", text.strip())] if text else []


class Property:
    def __init__(self, element):
        self.element = element
        self.name = element.get("name")
        self.kind = element.tag
        self.command = element.get("command")
        self.repeats = element.get("repeat_command") == "1"
        self.count = int(element.get("number_of_elements_per_command") or element.get("number_of_elements") or 1)
        self.information = element.get("information_only") == "1"
        self.types = (element.get("element_types") or "").split()
        self.domains = [child.tag for child in element if child.tag.endswith("Domain")]
        self.labels = [label.get("label") for label in element.iter("ComponentLabel")]
        self.text = " ".join((element.findtext("Documentation") or "").split())
        self.decorators = list(element.iter("PropertyWidgetDecorator"))
        self.entries = {entry.get("value") for entry in element.iter("Entry")} or ({"0", "1"} if "BooleanDomain" in self.domains else set())

    @property
    def array(self):
        return self.command == "SetInputArrayToProcess"

    @property
    def table(self):
        return self.repeats


class Proxy:
    def __init__(self, path):
        found = [e for e in ElementTree.parse(path).getroot().iter() if e.tag in ("SourceProxy", "WriterProxy")]
        assert len(found) == 1, f"{path}: one source, filter or writer a file"
        self.element, self.path = found[0], path
        self.name = self.element.get("name")
        self.properties = [Property(child) for child in self.element if child.tag.endswith("Property")]
        self.by_name = {p.name: p for p in self.properties}
        self.groups = [(g.get("label"), [p.get("name") for p in g.findall("Property")], list(g.iter("PropertyWidgetDecorator")))
                       for g in self.element.findall("PropertyGroup")]
        self.writes = self.element.tag == "WriterProxy"  # its panel is a dialogue of File, Save Data
        self.shown = [p for p in self.properties if not p.information and p.kind not in ("InputProperty", "ProxyProperty")]


PROXIES = [Proxy(path) for path in sorted((SOURCES / "pvplugin").glob("*.xml")) if path.name != "Curves.xml"]  # representations


class Panels(unittest.TestCase):
    def each(self, wanted=lambda p: True):
        for proxy in PROXIES:
            for shown in proxy.shown:
                if wanted(shown):
                    with self.subTest(f"{proxy.name}.{shown.name}"):
                        yield proxy, shown

    def test_every_class_has_a_panel(self):
        headers = [*(SOURCES / "solvers/vtk").glob("vtk*.h"), *(SOURCES / "filters").glob("vtk*.h")]
        classes = {h.stem for h in headers if f"static {h.stem}* New()" in h.read_text(encoding="utf-8")}
        self.assertEqual(classes, {proxy.element.get("class") for proxy in PROXIES})
        listed = re.findall(r"^\s+(\w+)\.xml$", (SOURCES / "pvplugin/CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(sorted(listed), [proxy.path.stem for proxy in PROXIES])

    def test_proxies(self):
        for proxy in PROXIES:
            with self.subTest(proxy.name):
                self.assertEqual([proxy.name, "vtk" + proxy.name], [proxy.path.stem, proxy.element.get("class")])
                told = proxy.element.find("Documentation")
                self.assertTrue(told.text.strip() and told.get("short_help") and told.get("long_help"))
                if not proxy.writes:
                    self.assertEqual(proxy.element.find("Hints/ShowInMenu").get("category"), "Lamella")
                for given in proxy.element.findall("InputProperty"):
                    self.assertIsNotNone(given.find("DataTypeDomain"), given.get("name"))
                    self.assertTrue(given.findtext("Documentation").strip())

    def test_documentation(self):
        for proxy in PROXIES:
            for p in proxy.properties:
                self.assertTrue(p.text.endswith((".", ")")), f"{proxy.name}.{p.name}: {p.text!r} is no sentence")

    def test_domains(self):
        for proxy, p in self.each():
            if p.array:
                self.assertIn("ArrayListDomain", p.domains)
            elif p.kind != "StringVectorProperty" and not p.table:  # a table with a range shows that beside it
                self.assertTrue(p.domains, "has no range, no list and is no switch")
            elif p.element.get("name", "").endswith(("File", "FileName")):
                self.assertTrue("FileListDomain" in p.domains or proxy.writes)
            for domain in p.element:
                default = numbers(p.element.get("default_values")) if domain.tag.endswith("RangeDomain") and not p.repeats else []
                for value, low, high in zip(default, numbers(domain.get("min")) or [-math.inf] * 9, numbers(domain.get("max")) or [math.inf] * 9):
                    self.assertTrue(low <= value <= high, f"the default {value} is not in {low} ... {high}")
            self.assertFalse("BooleanDomain" in p.domains and p.count > 1, "ParaView shows one box for all of its numbers")
            self.assertNotIn("IdType", p.kind, "ParaView shows no field for these: make it an IntVectorProperty")
            if "EnumerationDomain" in p.domains:
                self.assertIn(p.element.get("default_values"), p.entries)
            for needed in p.element.iter("RequiredProperties"):
                for other in needed:
                    self.assertIn(other.get("name"), proxy.by_name)

    def test_units(self):
        for _, p in self.each(lambda p: p.kind == "DoubleVectorProperty" or "1" in p.types):
            if p.name in PURE and not p.labels:
                continue
            self.assertEqual(len(p.labels), p.count, "give the unit of every number as a ComponentLabel, or list the property as PURE")
            units = [bool(re.search(r"\[\S.*\]", label)) for label in p.labels]
            if p.name not in PURE:
                self.assertTrue(any(units), f"{p.labels} have no unit")

    def test_titles(self):
        for proxy in PROXIES:
            if len(proxy.shown) > 10:
                missing = {p.name for p in proxy.shown} - {name for _, names, _ in proxy.groups for name in names}
                self.assertFalse(missing, f"{proxy.name}: in no group")
            for _, names, _ in proxy.groups:
                self.assertFalse(set(names) - set(proxy.by_name), f"{proxy.name}: not there")
        for proxy, p in self.each(lambda p: p.table):  # ParaView gives a table no label of its own
            self.assertIn([p.name], [names for _, names, _ in proxy.groups], "a table stands in a group of its own")

    def test_decorators(self):
        for proxy in PROXIES:
            for where, decorators in [*((p.name, p.decorators) for p in proxy.properties), *((g[0], g[2]) for g in proxy.groups)]:
                for decorator in decorators:
                    with self.subTest(f"{proxy.name}: {where}"):
                        other = proxy.by_name[decorator.get("property")]
                        values = (decorator.get("values") or decorator.get("value")).split()
                        self.assertFalse(set(values) - other.entries, f"{other.name} is never {values}")
                        self.assertIn(decorator.get("mode"), ("visibility", "enabled_state"))

    def test_states_have_a_slider(self):
        for proxy in PROXIES:
            if "State" in proxy.by_name:
                ends = proxy.by_name["StateRange"]
                self.assertTrue(ends.information)
                self.assertEqual(proxy.by_name["State"].element.find(".//RequiredProperties/Property").get("function"), "RangeInfo")

    def test_defaults_are_those_of_the_classes(self):
        compared = 0
        for proxy, p in self.each():
            setter = p.command or ""
            fresh = getattr(lamella, proxy.element.get("class"))()
            if p.repeats:
                if p.name not in DEFAULTS_FOR_A_START:
                    self.assertIn(p.element.get("default_values"), ("none", None))
                continue
            getter = getattr(fresh, "G" + setter[1:], None)
            if p.array or getter is None:
                self.assertTrue(p.array or "File" in p.name, f"no getter for {setter}")
                continue
            value = getter()
            if p.kind == "StringVectorProperty":
                self.assertEqual(p.element.get("default_values") or "", value or "")
            else:
                value = [float(v) for v in (value if isinstance(value, tuple) else (value,))]
                self.assertEqual(numbers(p.element.get("default_values")), value)
            compared += 1
        self.assertGreater(compared, 200)


if __name__ == "__main__":
    unittest.main(argv=["panels"], verbosity=2)
