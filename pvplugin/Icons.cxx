// The icons of the menus, as resources of Qt: ":/lamella/heat.svg". Only ParaView's window has Qt; elsewhere its
// function is not there, and nothing happens. So the plugin needs no Qt, and the same one loads in pvpython, in servers
// and in the window.
#include "Icons.h" // tree, names, contents; made by the build

[[gnu::weak]] bool qRegisterResourceData(int version, const unsigned char*, const unsigned char*, const unsigned char*);

namespace
{

[[maybe_unused]] const bool Registered =
  qRegisterResourceData != nullptr && qRegisterResourceData(1, tree, names, contents);

} // namespace
