// Labels tell units: the titles of colour bars, which ParaView by itself makes of the array's name alone, and of a
// chart's axes, which it leaves empty. The units are those that the arrays carry (ShownUnit.h), so data of other
// sources are labelled as before, and so are data of a server, which this process does not have. What somebody wrote
// stays.
#include "ShownUnit.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyManager.h"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace
{

/// The array that a representation draws; null where this process does not have it.
vtkDataArray* ArrayOf(vtkSMProxy* representation, int association, const char* name)
{
  vtkSMPropertyHelper input(representation, "Input");
  vtkSMProxy* const source = input.GetNumberOfElements() > 0 ? input.GetAsProxy() : nullptr;
  auto* const algorithm = source ? vtkAlgorithm::SafeDownCast(source->GetClientSideObject()) : nullptr;
  vtkDataObject* const data =
    algorithm ? algorithm->GetOutputDataObject(static_cast<int>(input.GetOutputPort())) : nullptr;
  vtkFieldData* const arrays = data ? data->GetAttributesAsFieldData(association) : nullptr;
  return arrays && name ? vtkDataArray::SafeDownCast(arrays->GetAbstractArray(name)) : nullptr;
}

std::string InBrackets(vtkDataArray* array)
{
  const std::string unit = array ? lamella::shownUnit(array) : "";
  return unit.empty() ? "" : " (" + unit + ")";
}

class Labels
{
public:
  void Watch()
  {
    if (vtkSMProxyManager::IsInitialized())
      vtkSMProxyManager::GetProxyManager()->AddObserver(vtkCommand::RegisterEvent, this, &Labels::Register);
  }

private:
  void Register(vtkObject*, unsigned long, void* called)
  {
    const auto& registered = *static_cast<vtkSMProxyManager::RegisteredProxyInformation*>(called);
    if (registered.Type != vtkSMProxyManager::RegisteredProxyInformation::PROXY || !registered.Proxy)
      return;
    const std::string_view group = registered.GroupName;
    if (group == "scalar_bars")
      registered.Proxy->AddObserver(vtkCommand::PropertyModifiedEvent, this, &Labels::NameBar);
    else if (group == "representations" && registered.Proxy->GetProperty("XArrayName") &&
      registered.Proxy->GetProperty("SeriesVisibility"))
    {
      registered.Proxy->AddObserver(vtkCommand::PropertyModifiedEvent, this, &Labels::NameAxes);
      registered.Proxy->AddObserver(vtkCommand::UpdateDataEvent, this, &Labels::NameAxes);
    }
  }

  /// The unit stands behind the name, or behind the component's.
  void NameBar(vtkObject* caller, unsigned long, void*)
  {
    auto* const bar = static_cast<vtkSMProxy*>(caller);
    vtkSMPropertyHelper title(bar, "Title");
    vtkSMPropertyHelper component(bar, "ComponentTitle");
    vtkSMProxy* const colors = vtkSMPropertyHelper(bar, "LookupTable").GetAsProxy();
    for (unsigned int i = 0; colors && i < colors->GetNumberOfConsumers(); ++i)
    {
      vtkSMProxy* const consumer = colors->GetConsumerProxy(i); // null once it is deleted
      vtkSMProxy* const drawn = consumer ? consumer->GetTrueParentProxy() : nullptr;
      if (!drawn || !drawn->GetProperty("ColorArrayName") || !drawn->GetProperty("Input"))
        continue;
      const vtkSMPropertyHelper shown(drawn, "ColorArrayName");
      const char* const name = shown.GetInputArrayNameToProcess();
      vtkDataArray* const array = ArrayOf(drawn, shown.GetInputArrayAssociation(), name);
      const std::string unit = InBrackets(array);
      if (unit.empty() || std::string_view(title.GetAsString()) != name)
        continue;
      const std::string part = component.GetAsString();
      if (array->GetNumberOfComponents() == 1)
        title.Set((name + unit).c_str());
      else if (!part.empty() && part.find('(') == std::string::npos)
        component.Set((part + unit).c_str());
      return;
    }
  }

  /// Of the columns that are drawn, where any of them tells its unit, if only that it is a ratio.
  void NameAxes(vtkObject* caller, unsigned long, void*)
  {
    auto* const curve = static_cast<vtkSMProxy*>(caller);
    if (vtkSMPropertyHelper(curve, "Visibility").GetAsInt() == 0)
      return;
    bool told = false;
    const auto unitOf = [&](const std::string& name)
    {
      vtkDataArray* const array = ArrayOf(curve, vtkDataObject::ROW, name.c_str());
      told = told || (array && !lamella::description(array)[0].empty());
      return InBrackets(array);
    };
    const bool rows = vtkSMPropertyHelper(curve, "UseIndexForXAxis").GetAsInt() != 0;
    const std::string across = rows ? "" : vtkSMPropertyHelper(curve, "XArrayName").GetAsString();
    const std::string bottom = rows ? "" : across + unitOf(across);
    vtkSMPropertyHelper series(curve, "SeriesVisibility");
    std::string names;
    std::string labels;
    std::set<std::string> units;
    for (unsigned int i = 0; i + 1 < series.GetNumberOfElements(); i += 2)
    {
      const std::string name = series.GetAsString(i);
      if (series.GetAsString(i + 1) != std::string_view("1") || name == across)
        continue;
      const std::string unit = *units.insert(unitOf(name)).first;
      names += (names.empty() ? "" : ", ") + name;
      labels += (labels.empty() ? "" : ", ") + name + unit;
    }
    const std::string left = units.size() == 1 ? names + *units.begin() : labels; // one unit once
    for (unsigned int i = 0; i < curve->GetNumberOfConsumers(); ++i)
    {
      this->SetTitle(curve->GetConsumerProxy(i), "BottomAxisTitle", told ? bottom : "");
      this->SetTitle(curve->GetConsumerProxy(i), "LeftAxisTitle", told ? left : "");
    }
  }

  /// Of a chart: an empty one, or the one before that came from here.
  void SetTitle(vtkSMProxy* view, const char* name, const std::string& text)
  {
    if (!view || !view->GetProperty(name))
      return;
    vtkSMPropertyHelper title(view, name);
    std::string& given = this->Given[{ view, name }];
    const std::string present = title.GetAsString();
    if (present == text || !(present.empty() || present == given))
      return;
    title.Set(text.c_str());
    view->UpdateVTKObjects();
    given = text;
  }

  std::map<std::pair<vtkSMProxy*, std::string>, std::string> Given;
};

[[maybe_unused]] const bool Watching = []
{
  static Labels labels;
  labels.Watch();
  return true;
}();

} // namespace
