#pragma once

// A window with an orbiting camera, a mouse that can grab things, and a panel of sliders (GLFW and Dear ImGui).

#include "third_party_glue/draw_list.h"

#include <memory>
#include <string>
#include <vector>

namespace pliant_glue {

/// A number the user may drag. `value` is borrowed.
struct WindowSlider
{
	std::string name;
	float* value = nullptr;
	float low = 0, high = 1;
	bool isLogarithmic = false;
};

/// The panel's text and knobs, and what the user asked for since the last picture.
struct WindowPanel
{
	std::string title;
	std::vector<std::string> lines;
	std::vector<WindowSlider> sliders;
	bool paused = false;    ///< kept by the user
	bool showNodes = false; ///< kept by the user
	bool stepOnce = false;  ///< true for one picture
	bool restart = false;   ///< true for one picture
};

struct MouseRay
{
	Vec3 from;
	Vec3 direction; ///< unit length
};

/// What is held down of the keys that a game has.
struct WindowKeys
{
	float ahead = 0, aside = 0; ///< W or up 1, S or down -1; D or right 1, A or left -1
	bool space = false, tab = false;
};

class Window
{
public:
	/// Null when there is no display or no OpenGL 3.3; `why` then says so. Its context is current on the calling thread.
	static std::unique_ptr<Window> create( const std::string& title, int width, int height, std::string& why );
	~Window();
	Window( const Window& ) = delete;
	Window& operator=( const Window& ) = delete;

	/// Take input: the right button turns the camera, the middle one shifts it, the wheel goes near and far. False once closed.
	bool takeInput( DrawCamera& camera );
	/// Held left button, not over the panel.
	bool isGrabbing() const;
	/// Held key C, while nothing is typed into the panel.
	bool isCutting() const;
	/// None while something is typed into the panel.
	WindowKeys keys() const;
	MouseRay mouseRay( const DrawCamera& camera ) const;

	/// Between the last two calls of takeInput.
	double secondsSinceLastPicture() const;

	int width() const; ///< of the framebuffer, pixels
	int height() const;

	/// Draw the panel over the picture and show both.
	void present( WindowPanel& panel );

private:
	Window();
	struct State;
	std::unique_ptr<State> m_state;
};

} // namespace pliant_glue
