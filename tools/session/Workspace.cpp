#include "session/Workspace.h"

#include "session/Text.h"

#include "core/Error.h"

#include <vtkDataObject.h>
#include <vtkInformation.h>

namespace lamella::cli
{

namespace
{

constexpr const char* mark = "memory:";

Workspace* only = nullptr;

} // namespace

Workspace::Workspace()
{
  only = this;
}

Workspace::~Workspace()
{
  only = nullptr;
}

void Workspace::keep(const std::filesystem::path& name, vtkDataObject* data)
{
  only->put(name, data);
}

vtkSmartPointer<vtkDataObject> Workspace::find(const std::filesystem::path& name)
{
  return only->get(name);
}

bool Workspace::holds(const std::filesystem::path& path)
{
  return only != nullptr && path.native().starts_with(mark);
}

std::string Workspace::nameOf(const std::string& data, const std::string& ending)
{
  return mark + data + ending;
}

void Workspace::put(const std::filesystem::path& name, vtkDataObject* data)
{
  auto kept = vtkSmartPointer<vtkDataObject>::Take(data->NewInstance());
  kept->ShallowCopy(data);
  if (data->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()) != 0)
  {
    kept->GetInformation()->Set(
      vtkDataObject::DATA_TIME_STEP(), data->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
  }
  data_[name.string()] = kept;
}

vtkSmartPointer<vtkDataObject> Workspace::get(const std::filesystem::path& name) const
{
  const auto found = data_.find(name.string());
  if (found == data_.end())
  {
    throw InputError("there is nothing called '" + name.string() + "'",
      "there are " + quotedList(names(), "and") + "; say which with of = \"NAME\"");
  }
  auto data = vtkSmartPointer<vtkDataObject>::Take(found->second->NewInstance());
  data->ShallowCopy(found->second);
  return data;
}

bool Workspace::has(const std::filesystem::path& name) const
{
  return data_.contains(name.string());
}

void Workspace::clear()
{
  data_.clear();
}

void Workspace::erase(const std::filesystem::path& name)
{
  data_.erase(name.string());
}

std::vector<std::string> Workspace::names() const
{
  std::vector<std::string> list;
  for (const auto& [name, data] : data_)
    list.push_back(name);
  return list;
}

} // namespace lamella::cli
