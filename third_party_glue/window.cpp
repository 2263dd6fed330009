// +-----------------------------------------------------------------------------------------------------------------+
// | GLFW makes the window, Dear ImGui the panel; the picture itself is the renderer's.                                |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/window.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <glm/glm.hpp>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace pliant_glue {

namespace {

constexpr float kRadiansPerPixel = 0.006f;
constexpr float kZoomPerNotch = 0.9f;
constexpr float kMaxTilt = 1.5f; // rad; short of the pole, where left and right are lost

glm::vec3 toGlm( const Vec3& v )
{
	return { v[0], v[1], v[2] };
}

Vec3 fromGlm( const glm::vec3& v )
{
	return { v.x, v.y, v.z };
}

} // namespace

struct Window::State
{
	GLFWwindow* window = nullptr;
	bool hasPanel = false;
	double mouseX = 0, mouseY = 0;
	double now = 0, before = 0;
};

Window::Window() : m_state( new State ) {}

Window::~Window()
{
	if ( m_state->hasPanel )
	{
		ImGui_ImplOpenGL3_Shutdown();
		ImGui_ImplGlfw_Shutdown();
		ImGui::DestroyContext();
	}
	if ( m_state->window != nullptr )
	{
		glfwDestroyWindow( m_state->window );
	}
	glfwTerminate();
}

std::unique_ptr<Window> Window::create( const std::string& title, int width, int height, std::string& why )
{
	if ( glfwInit() != GLFW_TRUE )
	{
		why = "there is no display";
		return nullptr;
	}
	std::unique_ptr<Window> made( new Window );
	glfwWindowHint( GLFW_CONTEXT_VERSION_MAJOR, 3 );
	glfwWindowHint( GLFW_CONTEXT_VERSION_MINOR, 3 );
	glfwWindowHint( GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE );
	glfwWindowHint( GLFW_SAMPLES, 4 );
	State& state = *made->m_state;
	state.window = glfwCreateWindow( width, height, title.c_str(), nullptr, nullptr );
	if ( state.window == nullptr )
	{
		why = "no window with OpenGL 3.3 could be opened";
		return nullptr;
	}
	glfwMakeContextCurrent( state.window );
	glfwSwapInterval( 1 );
	ImGui::CreateContext();
	ImGui::GetIO().IniFilename = nullptr; // leaves no file behind
	state.hasPanel = ImGui_ImplGlfw_InitForOpenGL( state.window, true ) && ImGui_ImplOpenGL3_Init( "#version 330 core" );
	if ( !state.hasPanel )
	{
		why = "the panel could not be made";
		return nullptr;
	}
	return made;
}

bool Window::takeInput( DrawCamera& camera )
{
	State& state = *m_state;
	state.before = state.now;
	state.now = glfwGetTime();
	glfwPollEvents();
	ImGui_ImplOpenGL3_NewFrame();
	ImGui_ImplGlfw_NewFrame();
	ImGui::NewFrame();

	double x = 0, y = 0;
	glfwGetCursorPos( state.window, &x, &y );
	const float dx = float( x - state.mouseX ), dy = float( y - state.mouseY );
	state.mouseX = x;
	state.mouseY = y;
	const ImGuiIO& io = ImGui::GetIO();
	if ( !io.WantCaptureMouse )
	{
		const glm::vec3 target = toGlm( camera.target );
		const glm::vec3 back = toGlm( camera.eye ) - target;
		float distance = glm::length( back );
		float turn = std::atan2( back.x, back.z );
		float tilt = std::asin( std::clamp( back.y / distance, -1.0f, 1.0f ) );
		glm::vec3 shift( 0.0f );
		if ( glfwGetMouseButton( state.window, GLFW_MOUSE_BUTTON_RIGHT ) == GLFW_PRESS )
		{
			turn -= dx * kRadiansPerPixel;
			tilt = std::clamp( tilt + dy * kRadiansPerPixel, -kMaxTilt, kMaxTilt );
		}
		if ( glfwGetMouseButton( state.window, GLFW_MOUSE_BUTTON_MIDDLE ) == GLFW_PRESS )
		{
			const glm::vec3 right = glm::normalize( glm::cross( -back, glm::vec3( 0, 1, 0 ) ) );
			const glm::vec3 up = glm::normalize( glm::cross( right, -back ) );
			shift = ( up * dy - right * dx ) * distance / float( std::max( height(), 1 ) );
		}
		distance *= std::pow( kZoomPerNotch, io.MouseWheel );
		const glm::vec3 direction( std::sin( turn ) * std::cos( tilt ), std::sin( tilt ), std::cos( turn ) * std::cos( tilt ) );
		camera.target = fromGlm( target + shift );
		camera.eye = fromGlm( target + shift + direction * distance );
	}
	if ( glfwGetKey( state.window, GLFW_KEY_ESCAPE ) == GLFW_PRESS )
	{
		glfwSetWindowShouldClose( state.window, GLFW_TRUE );
	}
	return glfwWindowShouldClose( state.window ) == GLFW_FALSE;
}

bool Window::isGrabbing() const
{
	return !ImGui::GetIO().WantCaptureMouse && glfwGetMouseButton( m_state->window, GLFW_MOUSE_BUTTON_LEFT ) == GLFW_PRESS;
}

bool Window::isCutting() const
{
	return !ImGui::GetIO().WantCaptureKeyboard && glfwGetKey( m_state->window, GLFW_KEY_C ) == GLFW_PRESS;
}

WindowKeys Window::keys() const
{
	WindowKeys keys;
	if ( ImGui::GetIO().WantCaptureKeyboard )
	{
		return keys;
	}
	const auto isDown = [this]( int key ) { return glfwGetKey( m_state->window, key ) == GLFW_PRESS; };
	const auto axis = [&]( int more, int orMore, int less, int orLess ) {
		return float( isDown( more ) || isDown( orMore ) ) - float( isDown( less ) || isDown( orLess ) );
	};
	keys.ahead = axis( GLFW_KEY_W, GLFW_KEY_UP, GLFW_KEY_S, GLFW_KEY_DOWN );
	keys.aside = axis( GLFW_KEY_D, GLFW_KEY_RIGHT, GLFW_KEY_A, GLFW_KEY_LEFT );
	keys.space = isDown( GLFW_KEY_SPACE );
	keys.tab = isDown( GLFW_KEY_TAB );
	return keys;
}

MouseRay Window::mouseRay( const DrawCamera& camera ) const
{
	int w = 1, h = 1; // the cursor counts in window units, which need not be pixels
	glfwGetWindowSize( m_state->window, &w, &h );
	const glm::vec3 eye = toGlm( camera.eye );
	const glm::vec3 forward = glm::normalize( toGlm( camera.target ) - eye );
	const glm::vec3 right = glm::normalize( glm::cross( forward, glm::vec3( 0, 1, 0 ) ) );
	const glm::vec3 up = glm::cross( right, forward );
	const float halfHeight = std::tan( glm::radians( camera.fieldOfView ) / 2 );
	const float u = ( 2 * float( m_state->mouseX ) / float( std::max( w, 1 ) ) - 1 ) * halfHeight * float( w ) / float( std::max( h, 1 ) );
	const float v = ( 1 - 2 * float( m_state->mouseY ) / float( std::max( h, 1 ) ) ) * halfHeight;
	return { camera.eye, fromGlm( glm::normalize( forward + right * u + up * v ) ) };
}

double Window::secondsSinceLastPicture() const
{
	return m_state->now - m_state->before;
}

int Window::width() const
{
	int w = 0, h = 0;
	glfwGetFramebufferSize( m_state->window, &w, &h );
	return w;
}

int Window::height() const
{
	int w = 0, h = 0;
	glfwGetFramebufferSize( m_state->window, &w, &h );
	return h;
}

void Window::present( WindowPanel& panel )
{
	ImGui::SetNextWindowPos( ImVec2( 12, 12 ), ImGuiCond_FirstUseEver );
	ImGui::Begin( panel.title.c_str(), nullptr, ImGuiWindowFlags_AlwaysAutoResize );
	ImGui::Checkbox( "pause", &panel.paused );
	ImGui::SameLine();
	panel.stepOnce = ImGui::Button( "step" );
	ImGui::SameLine();
	panel.restart = ImGui::Button( "restart" );
	ImGui::SameLine();
	ImGui::Checkbox( "nodes", &panel.showNodes );
	for ( const WindowSlider& slider : panel.sliders )
	{
		ImGui::SliderFloat( slider.name.c_str(), slider.value, slider.low, slider.high, "%.3g",
			slider.isLogarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None );
	}
	ImGui::Separator();
	for ( const std::string& line : panel.lines )
	{
		ImGui::TextUnformatted( line.c_str() );
	}
	ImGui::TextUnformatted( "left: grab   right: turn   middle: shift   wheel: zoom   C held: cut along the mouse" );
	ImGui::End();
	ImGui::Render();
	ImGui_ImplOpenGL3_RenderDrawData( ImGui::GetDrawData() );
	glfwSwapBuffers( m_state->window );
}

} // namespace pliant_glue
