#pragma once

namespace lamella::rendering
{

/// Two places in Debian's libraries take "there is no X server" for "nothing can be drawn", though our windows need
/// none. Each asks through one imported function, and that one call, in that one library, is led to a function of ours
/// by rewriting its slot in the library's linkage table (as the dynamic linker does when it binds the call):
///
/// - `glewInit` in VTK's OpenGL library. GLEW answers "no GLX display" after it has found every function. Our own
///   windows accept that, but pvbatch and pvserver wrap each view in a window class of ParaView's that shares our
///   context, asks GLEW again, and prints an error at every rendering. The redirected call takes that answer for
///   success.
/// - `XOpenDisplay` and `XCloseDisplay` in ParaView's view library, which call them only to find out whether this
///   process can draw, and leave a parallel pvbatch hanging when one rank says no. The redirected calls say yes.
///
/// To be called once, where windows without a display are installed. Where a library or a call is not found nothing
/// happens: pvpython draws the same, with GLEW's lines; a parallel pvbatch needs its switch --disable-xdisplay-test.
void RedirectDisplayTests();

} // namespace lamella::rendering
