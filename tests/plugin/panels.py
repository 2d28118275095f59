"""The panels of ParaView, which the build makes of the classes' headers: every property says what it is and in which unit, the
class's own default is the header's, every setter that Python has is declared, and what a panel showed under a name it still does.

panels.py SOURCES PANELS
"""

import json
import pathlib
import re
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import lamella
from vtkmodules.vtkCommonCore import vtkStringArray

SOURCES, PANELS = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCES / "tools/settings"))
import pages  # noqa: E402  pylint: disable=wrong-import-position
from headers import Declarations, HeaderError, Reader  # noqa: E402  pylint: disable=wrong-import-position
from make import headers_of  # noqa: E402  pylint: disable=wrong-import-position

DECLARED = Declarations(headers_of(SOURCES))
CLASSES = [name for name, kind in DECLARED.classes.items() if not kind.abstract]
# Objects that are handed over, and what sets several at once by a name
NO_SETTINGS = {"SetController", "SetInputData", "SetInputConnection", "AddInputData", "AddInputConnection", "SetImageData", "SetImageConnection",
               "SetPictureConnection", "SetPictureData", "SetPointsConnection", "AddPointsData", "SetOverlayLines", "SetPresetByName", "SetOverlayByName", "AddNotchInSpace", "SetSolver"}
# Numbers without a unit: shares, strains, ratios, counts, values in units of the data
PURE = re.compile(r"share|strain|ratio|spacing|lattice unit|in any unit|over the|of all tensile|tensile stresses|number|relative|seed|nodes|"
                  r"pixels|tolerance|residual|kinetic|Poisson|value|smoothed|standard deviation|speed|friction|length|coordinates|channel|opacity|place|position|axis|wave|grains|colour|background", re.I)


class Panels(unittest.TestCase):
    def test_every_class_has_a_panel(self):
        made = {"vtk" + path.stem for path in PANELS.glob("*.xml")}
        self.assertEqual(set(CLASSES) - made, {"vtkSnapshot", "vtkFileConverter"})  # draw, convert: no source or filter

    def test_menus(self):
        """A source or filter is in a group, whose icon there is. ParaView's search looks for its words in the help, too."""
        words = {"heat": "heat or vapour", "elements": "element", "bonds": "peridynamics", "points": "MPM"}
        for path in PANELS.glob("*.xml"):
            root = ElementTree.parse(path).getroot()
            found = root.find(".//ShowInMenu")
            with self.subTest(path.stem):
                if root.find("ProxyGroup").get("name") == "writers":
                    self.assertIsNone(found)
                    continue
                icon = re.fullmatch(r":/lamella/(\w+)\.svg", found.get("icon"))[1]
                self.assertTrue((SOURCES / f"pvplugin/icons/{icon}.svg").exists())
                told = root.find(".//Documentation")
                self.assertRegex(told.text + told.get("long_help"), words.get(icon, "."))

    def test_parts_have_what_a_fit_leaves_open(self):
        """Of each solver the panel of the fit shows all that the command has an option for, with the class's own defaults."""
        root = ElementTree.parse(PANELS / "MaterialFit.xml").getroot()
        parts = root.findall("ProxyGroup[@name='lamella_parts']/Proxy")
        self.assertEqual([part.get("class") for part in parts], ["vtkSteadyDiffusion", "vtkVoxelStiffness"])
        words = vtkStringArray()
        for part in parts:
            lamella.vtkMaterialFit.GetSettingsLeftOut(part.get("class"), words)
            left = {words.GetValue(i) for i in range(words.GetNumberOfValues())}
            settings = {setting.name: setting for setting in DECLARED.settings(part.get("class"))}
            shown = {name for name in settings if part.find(f"*[@name='{name}']") is not None}
            self.assertEqual({name for name, setting in settings.items() if setting.word not in left}, shown)
            self.assertEqual(part.find("*[@name='EstimateError']").get("default_values"), "1")

    def test_every_setter_is_declared(self):
        for name in CLASSES:
            settings = {setting.setter for kind in DECLARED.chain(name) for setting in kind.settings}  # also those that a class has no use for
            bases = [base for base in getattr(lamella, name).__mro__ if base.__module__.startswith("vtkmodules")]
            known = {method for base in bases for method in vars(base)}
            for method in dir(getattr(lamella, name)):
                if re.match(r"(Set|Add)[A-Z]", method) and method not in known:
                    self.assertIn(method, settings | NO_SETTINGS, f"{name}: a setter that is not understood")

    def test_defaults_are_those_of_the_classes(self):
        compared = 0
        for name in CLASSES:
            fresh = getattr(lamella, name)()
            for setting in DECLARED.settings(name):
                if setting.getter and setting.kind != "list":
                    value = getattr(fresh, setting.getter)()
                    value = list(value) if isinstance(value, tuple) else value
                    with self.subTest(f"{name}.{setting.name}"):
                        self.assertEqual(setting.default, value if value is not None else "")
                        compared += 1
        self.assertGreater(compared, 250)

    def test_settings_say_what_they_are(self):
        for name in CLASSES:
            for setting in DECLARED.settings(name):
                with self.subTest(f"{name}.{setting.name}"):
                    self.assertRegex(setting.text, r"[.)]$", "is no sentence")
                    self.assertNotRegex(setting.text, r"\bDefaults?\b", "the default is told by the member")
                    if setting.kind == "number" or "number" in setting.types:
                        about = f"{setting.text} {' '.join(setting.columns)}"
                        self.assertTrue(setting.unit or re.search(r"\[.+\]|metres|seconds|pascals|degrees", about) or PURE.search(about),
                                        "has no unit")

    def test_pages_have_the_tables_of_the_headers(self):
        for path in sorted((SOURCES / "docs/filters").glob("*.md")):
            self.assertEqual(path.read_text(encoding="utf-8"), pages.written(DECLARED, path), "run tools/settings/make.py pages .")

    def test_names_of_properties_and_choices_stay(self):
        """ParaView's state files and scripts hold them."""
        kept = json.loads((SOURCES / "tests/plugin/properties.json").read_text(encoding="utf-8"))
        for name, properties in kept.items():
            root = ElementTree.parse(PANELS / f"{name}.xml").getroot()
            there = {element.get("name"): [element.get("command"), *sorted(f"{entry.get('value')} {entry.get('text')}" for entry in element.iter("Entry"))]
                     for element in root.iter() if element.get("command")}
            for listed, words in properties.items():
                with self.subTest(f"{name}.{listed}"):
                    self.assertEqual(there.get(listed), words)


class Headers(unittest.TestCase):
    """What is not understood is loud."""

    def refused(self, body, pattern):
        path = pathlib.Path("header_that_is_wrong.h")
        path.write_text(f"class X_EXPORT vtkX : public vtkObject\n{{\npublic:\n{body}\nprivate:\n  double Load = 1;\n}};\n", encoding="utf-8")
        try:
            with self.assertRaisesRegex(HeaderError, pattern):
                Declarations([path])
        finally:
            path.unlink()

    def declared(self, body, other=""):
        paths = [pathlib.Path("header_x.h"), pathlib.Path("header_y.h")]
        paths[0].write_text(f"class X_EXPORT vtkX : public vtkObject\n{{\npublic:\n{body}\n}};\n", encoding="utf-8")
        paths[1].write_text(other, encoding="utf-8")
        try:
            return Declarations(paths if other else paths[:1])
        finally:
            for path in paths:
                path.unlink()

    def test_faults(self):
        self.refused("  /** A load.\n   * @rang [0, 1]\n   */\n  vtkSetMacro(Load, double);", r":7: @rang is not understood")
        self.refused("  /** A load.\n   * @range 0 to 1\n   */\n  vtkSetMacro(Load, double);", r"@range 0 to 1 is no interval")
        self.refused("  /** A load.\n   * @range [1, 0]\n   */\n  vtkSetMacro(Load, double);", "is empty")
        self.refused("  /** A load.\n   * @choice Loads\n   */\n  vtkSetMacro(Load, double);", "Loads is no enumerator")
        self.refused("  vtkSetMacro(Strain, double);", "the default of Strain is not told")
        self.refused("  vtkSetMacro(Load, unsigned);", "vtkSetMacro|SetMacro of unsigned is not understood")
        self.refused("  void AddBox(double x, double y);", "AddBox lists something that no RemoveAll... takes away")

    def test_one_macro_tells_setter_getter_and_default(self):
        for macro, kind, default in (("vtkSettingMacro(Load, double, 1)", "number", 1), ("vtkSwitchMacro(Load, false)", "switch", False),
                                     ("vtkSettingVector2Macro(Load, double, 1, 2)", "vector", [1, 2]), ('vtkSettingMacro(Load, std::string, "")', "text", "")):
            with self.subTest(macro):
                found = self.declared(f"  /** A load. */\n  {macro};").settings("vtkX")[0]
                self.assertEqual((found.setter, found.getter, found.name, found.text), ("SetLoad", "GetLoad", "Load", "A load."))
                self.assertEqual((found.kind, found.default), (kind, default))

    def test_a_setting_that_is_as_another_class_has_it(self):
        """All that its comment does not say is told there."""
        other = "\nclass Y_EXPORT vtkY : public vtkObject\n{\npublic:\n  /**\n   * A load.\n   * @unit N\n   * @range [0, 5]\n   */\n" \
            "  vtkSettingMacro(Load, double, 2);\n};\n"
        mine = "  /** As vtkY. */\n  vtkSettingMacro(Load, double, 1);"
        found = self.declared(mine, other).settings("vtkX")[0]
        self.assertEqual((found.text, found.unit, found.default), ("A load.", "N", 1))
        with self.assertRaisesRegex(HeaderError, "as vtkZ has it, which has none"):
            self.declared(mine.replace("vtkY", "vtkZ"), other)

    def test_words(self):
        found = Reader(SOURCES / "solvers/vtk/points/vtkPointCompression.h").read()
        self.assertEqual([entry[0] for entry in found.enums["Transfers"]], ["FLIP", "PIC", "APIC", "XPIC"])
        words = {setting.name: [choice.word for choice in setting.choices] for setting in DECLARED.settings("vtkBondFracture")}
        self.assertEqual(words["Mixing"], ["none", "harmonic", "minimum"])
        self.assertEqual(words["Continuum"], ["auto", "plane-stress", "plane-strain", "space"])
        self.assertEqual(words["LoadAxis"], ["last", "x", "y", "z"])


if __name__ == "__main__":
    unittest.main(argv=["panels"], verbosity=2)
