"""Makes ParaView's panel of a class, a server manager XML, of what its header declares and of a small file of what is layout
only: pvplugin/NAME.xml. Of a base class such a file gives what its subclasses share.

    <Panel class="vtkX" menu="bonds" label="X" short="A line for the menu" long="For the help">
      Text of the help; menu is a group of MENUS. name="Y": the proxy's, where X is one of ParaView's own.
      <Input data="vtkImageData" arrays="point 1">What is wanted.</Input>
      <Output>Name of a port</Output>
      <Array name="PhaseArray" index="0" default="phase" of="Scalars" group="Phases">An array of the input to choose.</Array>
      <Group label="Load" when="Pull"/>         the settings of a group of the header, in this place; or those named in it
      <Without>KeepStates</Without>             settings that the panel does not show
      <When is="Load BIAXIAL">Strain</When>     as @when in the header
      <Start setting="Voids">lumen</Start>      rows of a table at the start, where the class has none
      <Tells>PeakStress</Tells>                 what the last update found
      <Label setting="Load">Kind of load</Label>
      <Advanced/> <Plain/>                      names as in <Without>, of what is seldom needed, or often in this class
      <Chart name="LamellaX" port="1" x="strain" draws="stress" leaves="time">What a table shows.</Chart>
                                                opens that port as lines over a column, of the columns that a table has (Chart.xml)
      <Choose name="Solver">What solves.        an object of one of some classes, whose settings the panel shows under it
        <One class="vtkY">                      <Group> as above, <Start>: of its settings those that groups name are shown
          <Group label="Materials">YoungsModuli</Group>
        </One>
      </Choose>
    </Panel>

Anything else, such as <Hints>, goes into the XML as it is.
"""

import copy
import dataclasses
import math
import pathlib
import xml.etree.ElementTree as ElementTree

from headers import HeaderError, words_of

TAGS = {"whole": "IntVectorProperty", "choice": "IntVectorProperty", "switch": "IntVectorProperty", "number": "DoubleVectorProperty",
        "text": "StringVectorProperty", "file": "StringVectorProperty"}
ARRAY_TYPES = "0 0 0 0 2"
# Groups of the menus Sources and Filters, in the words of each field. A group's icon is pvplugin/icons/NAME.svg.
MENUS = {
    "samples": "Lamella: Samples (Micrographs, Grains)",
    "heat": "Lamella: Heat and Vapour (Diffusion, Lattice Boltzmann)",
    "elements": "Lamella: Stiffness and Stress (Elements)",
    "bonds": "Lamella: Elasticity and Fracture (Peridynamics)",
    "points": "Lamella: Compression and Crushing (MPM)",
    "analysis": "Lamella: Analysis (Flux, Pores, Stress, Cracks)",
}


class Panel:
    """The panel of one class: an XML tree that grows. @raises HeaderError for a layout that does not fit the header"""

    def __init__(self, declarations, layouts, chart, name):
        self.name, self.declarations, self.chart = name, declarations, chart
        self.chain = [layouts[kind.name] for kind in declarations.chain(name) if kind.name in layouts]
        self.layout = layouts[name]
        self.settings = {setting.name: setting for setting in declarations.settings(name)}
        self.when = {setting.name: setting.when for setting in self.settings.values() if setting.when}
        for element in self.each("When"):
            for setting in self.names(element):
                self.when[setting] = tuple(element.get("is").split())
        self.without = {setting for element in self.each("Without") for setting in self.names(element)}
        self.advanced = {setting.name for setting in self.settings.values() if setting.advanced}
        self.advanced |= {setting for element in self.each("Advanced") for setting in self.names(element)}
        self.advanced -= {setting for element in self.each("Plain") for setting in self.names(element)}
        self.arrays = {element.get("name"): element for element in self.each("Array")}
        self.labels = {element.get("setting"): element.text for element in self.each("Label")}
        self.start = {element.get("setting"): element.text for element in self.each("Start")}

    def fail(self, why):
        raise HeaderError(f"the panel of {self.name}: {why}")

    def each(self, tag):
        return [element for layout in self.chain for element in layout.findall(tag)]

    def names(self, element):
        found = (element.text or "").split()
        for name in found:
            if name not in self.settings and name not in [a.get("name") for a in self.each("Array")]:
                self.fail(f"there is no setting {name}")
        return found

    # ---- the tree

    def tree(self):
        layout = self.layout
        root = ElementTree.Element("ServerManagerConfiguration")
        kind = layout.get("proxies") or ("filters" if self.each("Input") else "sources")
        group = ElementTree.SubElement(root, "ProxyGroup", name=kind)
        proxy = ElementTree.SubElement(group, "WriterProxy" if kind == "writers" else "SourceProxy", {
            "class": self.name, "label": layout.get("label"), "name": layout.get("name", self.name[3:])})
        told = ElementTree.SubElement(proxy, "Documentation", short_help=layout.get("short"), long_help=layout.get("long"))
        told.text = " ".join(layout.text.split())
        for element in {element.get("name", "Input"): element for element in self.each("Input")}.values():
            self.add_input(proxy, element)
        for index, element in enumerate(layout.findall("Output")):
            ElementTree.SubElement(proxy, "OutputPort", index=str(index), name=element.text)
        for element in self.arrays.values():
            self.add_array(proxy, element)
        for element in layout.findall("Choose"):
            self.add_choose(root, proxy, element)
        for setting in self.settings.values():
            if setting.name not in self.without:
                self.add_setting(proxy, setting)
        tells = self.declarations.tells(self.name)
        for name in [name for element in self.each("Tells") for name in element.text.split()]:
            if name not in tells:
                self.fail(f"nothing tells {name}")
            self.add_told(proxy, name, *tells[name])
        self.add_groups(proxy)
        known = {"Input", "Output", "Array", "Group", "Without", "When", "Start", "Tells", "Advanced", "Plain", "Label", "Chart", "Choose"}
        proxy.extend(element for element in layout if element.tag not in known)
        for element in layout.findall("Chart"):
            self.add_chart(root, proxy, element)
        self.add_to_menu(proxy)
        ElementTree.indent(root)
        return root

    @staticmethod
    def hints_of(proxy):
        hints = proxy.find("Hints")
        return ElementTree.SubElement(proxy, "Hints") if hints is None else hints

    def add_chart(self, root, proxy, element):
        chart = copy.deepcopy(self.chart)
        chart.set("name", element.get("name"))
        chart.find("Documentation").text = element.text
        chart.find("*[@name='XArrayName']").set("default_values", element.get("x"))
        drawn = element.get("draws").split()
        columns = [*drawn, element.get("x"), *element.get("leaves").split()]
        shown = chart.find("*[@name='SeriesVisibility']")
        shown.set("number_of_elements", str(2 * len(columns)))
        shown.set("default_values", ";".join(f"{column};{int(column in drawn)}" for column in columns))
        ElementTree.SubElement(root, "ProxyGroup", name="representations").append(chart)
        about = {"port": element.get("port")}
        hints = self.hints_of(proxy)
        hints.insert(0, ElementTree.Element("View", type="XYChartView", **about))
        hints.insert(1, ElementTree.Element("Representation", view="XYChartView", type=element.get("name"), **about))

    def add_choose(self, root, proxy, element):
        """A property that is an object: ParaView makes one of each class, and its panel shows that which is chosen."""
        group = ElementTree.SubElement(root, "ProxyGroup", name="lamella_parts")
        found = ElementTree.SubElement(proxy, "ProxyProperty", name=element.get("name"), command="Set" + element.get("name"))
        listed = ElementTree.SubElement(found, "ProxyListDomain", name="proxy_list")
        self.document(found, element.text.strip())
        for one in element.findall("One"):
            name = one.get("class")
            part = Panel(self.declarations, {name: one}, self.chart, name)
            shown = {setting for group_of in one.findall("Group") for setting in part.names(group_of)}
            part.without = set(part.settings) - shown
            made = ElementTree.SubElement(group, "Proxy", {"class": name, "name": name[3:], "label": words_of(name[3:]).title()})
            ElementTree.SubElement(made, "Documentation").text = self.declarations.classes[name].brief
            for setting in part.settings.values():
                if setting.name in shown:
                    part.add_setting(made, dataclasses.replace(setting, panel=""))  # no live pipeline: with the class's own default
            part.add_groups(made)
            ElementTree.SubElement(listed, "Proxy", group="lamella_parts", name=name[3:])

    def add_to_menu(self, proxy):
        menu = next((layout.get("menu") for layout in reversed(self.chain) if layout.get("menu")), None)
        if menu in MENUS:
            hints = self.hints_of(proxy)
            # menu_label: ParaView 5.13 would make one of the category, with blanks after brackets
            ElementTree.SubElement(hints, "ShowInMenu", category=MENUS[menu], menu_label=MENUS[menu], icon=f":/lamella/{menu}.svg")
        elif menu:
            self.fail(f"there is no menu {menu}")

    @staticmethod
    def document(property_element, text):
        ElementTree.SubElement(property_element, "Documentation").text = text

    def add_input(self, proxy, element):
        given = {key: element.get(key) for key in ("port_index", "clean_command", "multiple_input") if element.get(key)}
        found = ElementTree.SubElement(proxy, "InputProperty", name=element.get("name", "Input"),
                                       command=element.get("command", "SetInputConnection"), **given)
        groups = ElementTree.SubElement(found, "ProxyGroupDomain", name="groups")
        for name in ("sources", "filters"):
            ElementTree.SubElement(groups, "Group", name=name)
        types = ElementTree.SubElement(found, "DataTypeDomain", name="input_type")
        if element.get("composite"):
            types.set("composite_data_supported", element.get("composite"))
        for name in element.get("data").split():
            ElementTree.SubElement(types, "DataType", value=name)
        for index, wanted in enumerate(filter(None, element.get("arrays", "").split(","))):
            where, *rest = wanted.split()
            attributes = {"attribute_type": where, "name": ("input_array", "input_vector")[index] if not element.get("domain") else element.get("domain")}
            if rest and rest[0].isdigit():
                attributes["number_of_components"] = rest[0]
            if "optional" in rest:
                attributes["optional"] = "1"
            ElementTree.SubElement(found, "InputArrayDomain", attributes)
        self.document(found, element.text.strip())
        if element.get("optional"):
            ElementTree.SubElement(ElementTree.SubElement(found, "Hints"), "Optional")

    def add_array(self, proxy, element):
        index, port = element.get("index"), element.get("port", "0")
        association = {"row": "6"}.get(element.get("where"), "0")
        found = ElementTree.SubElement(proxy, "StringVectorProperty", {
            "name": element.get("name"), "command": "SetInputArrayToProcess", "element_types": ARRAY_TYPES, "number_of_elements": "5",
            "default_values": f"{index};{port};0;{association};{element.get('default')}", "default_values_delimiter": ";", "animateable": "0"})
        if element.get("advanced"):
            found.set("panel_visibility", "advanced")
        arrays = ElementTree.SubElement(found, "ArrayListDomain", name="array_list", attribute_type=element.get("of"),
                                        input_domain_name=element.get("domain", "input_array"))
        needed = ElementTree.SubElement(arrays, "RequiredProperties")
        ElementTree.SubElement(needed, "Property", function="Input", name=element.get("input", "Input"))
        self.document(found, element.text.strip())
        hints = ElementTree.SubElement(found, "Hints")  # always this one, not the array that a view happens to show
        ElementTree.SubElement(hints, "NoDefault")
        self.decorate(element.get("name"), hints)

    def add_setting(self, proxy, setting):
        listed, count = setting.kind == "list", len(setting.types) or 1
        kind = setting.types[0] if setting.kind in ("vector", "list") else setting.kind
        if listed and len(set(setting.types)) > 1:
            kind = "text"
        attributes = {"name": setting.name, "command": setting.setter}
        if listed:
            rows = self.start.get(setting.name)
            attributes.update(clean_command=setting.clear, repeat_command="1", number_of_elements_per_command=str(count))
            if kind == "text" and count > 1:
                attributes["element_types"] = " ".join({"whole": "0", "number": "1", "text": "2"}[t] for t in setting.types)
            attributes["number_of_elements"] = str(len(rows.split(";")) if rows else 0)
            attributes["default_values"] = rows or "none"
            if rows:
                attributes["default_values_delimiter"] = ";"
        else:
            attributes["number_of_elements"] = str(count)
            attributes["default_values"] = self.default(setting)
        if setting.name in self.labels:
            attributes["label"] = self.labels[setting.name]
        if setting.name == "FileName":  # a file that there is not would be an error before one is chosen
            del attributes["default_values"]
        if listed or kind == "file" or setting.group == "Checkpoints":
            attributes["animateable"] = "0"
        if setting.name in self.advanced:
            attributes["panel_visibility"] = "advanced"
        found = ElementTree.SubElement(proxy, TAGS["number" if kind == "number" else kind], attributes)
        self.add_domain(found, setting, kind)
        self.document(found, setting.text)
        hints = ElementTree.Element("Hints")
        if listed and kind == "text" and count > 1:
            ElementTree.SubElement(hints, "AllowRestoreDefaults")
        labels = setting.columns or ([f"[{setting.unit}]"] if setting.unit else [])
        if labels:
            if len(labels) != count:
                self.fail(f"{setting.name} has {count} parts, and {len(labels)} columns are named")
            shown = ElementTree.SubElement(hints, "ShowComponentLabels")
            for index, label in enumerate(labels):
                ElementTree.SubElement(shown, "ComponentLabel", component=str(index), label=label)
        about, _, patterns = setting.files.partition(" (")
        if patterns not in ("", "*)"):
            ElementTree.SubElement(hints, "FileChooser", extensions=patterns.rstrip(")").replace("*.", ""), file_description=about)
            ElementTree.SubElement(hints, "AcceptAnyFile")
        self.decorate(setting.name, hints)
        if len(hints):
            found.append(hints)

    def default(self, setting):
        value = setting.default
        if setting.panel:
            value = next((entry.value for entry in setting.choices if entry.word == setting.panel), setting.panel == "on")
        if isinstance(value, list):
            return " ".join(self.number(part) for part in value)
        return value if isinstance(value, str) else self.number(value)

    @staticmethod
    def number(value):
        return str(int(value)) if isinstance(value, bool) or value == int(value) and abs(value) < 1e15 else repr(value)

    def add_domain(self, found, setting, kind):
        if setting.choices:
            domain = ElementTree.SubElement(found, "EnumerationDomain", name="enum")
            for choice in setting.choices:
                ElementTree.SubElement(domain, "Entry", text=choice.label, value=str(choice.value))
        elif setting.name == "State":
            domain = ElementTree.SubElement(found, "IntRangeDomain", name="range", min="-1", max="0", default_mode="min")
            needed = ElementTree.SubElement(domain, "RequiredProperties")
            ElementTree.SubElement(needed, "Property", function="RangeInfo", name="StateRange")
        elif kind == "switch":
            ElementTree.SubElement(found, "BooleanDomain", name="bool")
        elif kind == "file":
            ElementTree.SubElement(found, "FileListDomain", name="files")
        elif kind in ("whole", "number") and setting.kind != "list":
            domain = ElementTree.SubElement(found, "IntRangeDomain" if kind == "whole" else "DoubleRangeDomain", name="range")
            count = len(setting.types) or 1
            for key, end in (("min", setting.range.low), ("max", setting.range.high)):
                if math.isfinite(end):
                    domain.set(key, " ".join([self.number(end)] * count))

    def decorate(self, name, hints):
        if name not in self.when:
            return
        other, *words = self.when[name]
        if other not in self.settings or other in self.without:
            return
        self.decorator(hints, other, words)

    def decorator(self, hints, other, words):
        decorator = ElementTree.SubElement(hints, "PropertyWidgetDecorator", type="GenericDecorator", mode="visibility", property=other)
        values = self.values(self.settings[other], words)
        decorator.set("values" if len(values) > 1 else "value", " ".join(values))

    def values(self, setting, words):
        if not words:
            return ["1"]
        found = []
        for word in words:
            value = next((choice.value for choice in setting.choices if word == choice.name), None)
            if value is None:
                value = int(word) if word.lstrip("-").isdigit() else self.fail(f"{setting.name} is never {word}")
            found.append(str(value))
        return found

    def add_told(self, proxy, name, kind, count, text):
        whole = kind in ("whole", "switch")
        found = ElementTree.SubElement(proxy, "IntVectorProperty" if whole else "DoubleVectorProperty", {
            "name": name, "command": f"Get{name}", "information_only": "1", "number_of_elements": str(count),
            "default_values": "-1 0" if name == "StateRange" else "none"})
        ElementTree.SubElement(found, "SimpleIntInformationHelper" if whole else "SimpleDoubleInformationHelper")
        self.document(found, text)

    def add_groups(self, proxy):
        groups = self.layout.findall("Group")
        if not groups:
            return
        left = [name for name, setting in self.settings.items() if name not in self.without]
        for group in groups:
            label = group.get("label")
            arrays = [name for name, element in self.arrays.items() if element.get("group") == label]
            named = self.names(group)
            members = named or [name for name in left if self.settings[name].group == label]
            for name in members:
                if name in left:
                    left.remove(name)
            members = arrays + [name for name in members if name not in arrays]
            tables = [name for name in members if name in self.settings and self.settings[name].kind == "list"]
            for name in tables:
                self.add_group(proxy, self.settings[name].title or words_of(name).capitalize(), [name], None)
            rest = [name for name in members if name not in tables]
            if rest:
                self.add_group(proxy, label, rest, group.get("when"))
            elif not tables:
                self.fail(f"the group {label} is empty")
        left = [name for name in left if self.settings[name].group]  # what has none stands above all titles
        if left:
            self.fail(f"{', '.join(left)}: in no group of the panel; their groups are {', '.join({self.settings[n].group for n in left})}")
        # ParaView shows a group where the first of its properties stands
        first = list(proxy).index(proxy.find("PropertyGroup"))
        members = {element.get("name"): element for element in list(proxy)[:first]}
        for name in [member.get("name") for member in proxy.findall("PropertyGroup/Property")]:
            proxy.remove(members[name])
            proxy.insert(first - 1, members[name])

    def add_group(self, proxy, label, names, when):
        found = ElementTree.SubElement(proxy, "PropertyGroup", label=label)
        for name in names:
            ElementTree.SubElement(found, "Property", name=name)
        if when:
            other, *words = when.split()
            self.decorator(ElementTree.SubElement(found, "Hints"), other, words)


def read_layouts(folder):
    """Layouts by the name of their class, and how curves are drawn."""
    roots = [ElementTree.parse(path).getroot() for path in sorted(pathlib.Path(folder).glob("*.xml"))]
    return {root.get("class"): root for root in roots if root.tag == "Panel"}, next(root for root in roots if root.tag != "Panel")


def write(declarations, layouts, chart, name, path):
    tree = Panel(declarations, layouts, chart, name).tree()
    text = ElementTree.tostring(tree, encoding="unicode")
    pathlib.Path(path).write_text(f"<!-- Made from the header of {name} and the layout in pvplugin. -->\n{text}\n", encoding="utf-8")
